#include <algorithm>
#include <cmath>

#include "contacts/walking_feet_internal.h"

// Detects how a foot leaves the ground.

namespace krok::contacts {

namespace {

constexpr double kStair = 0.14;    // metres, rise of a stride
constexpr double kGravity = 9.81;  // metres per second squared
// Froude numbers, speed squared over gravity times leg length: above kRun people run; kFastest is
// the limit for a leg that vaults.
constexpr double kRun = 0.5, kFastest = 1;
constexpr double kFlat = 0.003;  // leg lengths, rise of the pelvis over a step
constexpr std::ptrdiff_t kStepsBefore = 2, kStepsAfter = 3;
constexpr double kFlatBefore = 0.35;  // cycles, from flat foot to toe-off
constexpr double kPitched = 0.06;     // leg lengths, heel above toes
// In a run the foot lands and leaves while its slowest point is at this fraction of its max speed,
// at most this long from where its contacts begin or end.
constexpr double kLanding = 0.12;
// Backwards a foot is dragged off its heel: it is off at this fraction. Between walks played in
// reverse, which leave at once, and captures, which leave gradually.
constexpr double kDragged = 0.06;
constexpr double kLandingWithin = 0.08;  // seconds
constexpr double kJog = 0.15;            // Froude number, 1.1 m/s: jumps on the spot are no run
constexpr double kTurnsWithin = 0.15;    // seconds, of the toes around the foot's back seed

// The fractional frame between a slow frame and its neighbour at which the speed passes `slow`.
template <typename Speed>
double crossed_at(const Speed& speed, int slow_frame, int fast_frame, double slow) {
  const double rise = speed(fast_frame) - speed(slow_frame);
  if (!(rise > 1e-9)) return slow_frame;
  const double part = std::clamp((slow - speed(slow_frame)) / rise, 0.0, 1.0);
  return slow_frame + part * (fast_frame - slow_frame);
}

}  // namespace

bool WalkingFeet::stays_level(const Foot& foot, double seed) const {
  const auto level = [&](double time) { return lowest_of(foot, frame_at(time)); };
  return std::abs(level(seed + 0.5 * foot.cycle) - level(seed - 0.3 * foot.cycle)) <
         kStair * leg_ / kUsualLeg;
}

double WalkingFeet::rise_over(const Foot& foot, double seed) const {
  for (const double front : foot.seeds.front) {
    if (front >= seed || front < seed - foot.cycle) continue;
    const auto height = [&](double time) { return pelvis_[frame_at(time)].y(); };
    return height(0.5 * (front + seed)) - 0.5 * (height(front) + height(seed));
  }
  return 0;
}

void WalkingFeet::find_carriage() {
  for (const Foot& foot : feet_) {
    for (const double seed : foot.seeds.back) {
      const double rise = rise_over(foot, seed);
      if (std::abs(rise) > kFlat * leg_) rises_.push_back({seed, rise > 0 ? 1 : -1});
    }
  }
  std::ranges::stable_sort(rises_, {}, &Rise::time);
}

WalkingFeet::Carriage WalkingFeet::carriage(double time) const {
  // A walk may become a run: the steps around count.
  const auto next = std::ranges::lower_bound(rises_, time, {}, &Rise::time);
  const auto before = std::min<std::ptrdiff_t>(kStepsBefore, next - rises_.begin());
  const auto after = std::min<std::ptrdiff_t>(kStepsAfter, rises_.end() - next);
  int more = 0;
  for (auto rise = next - before; rise != next + after; ++rise) more += rise->up;
  return more > 0 ? Carriage::vaults : more < 0 ? Carriage::bounces : Carriage::flat;
}

bool WalkingFeet::is_pitched(const Foot& foot, double seed) const {
  if (foot.tracks.size() < 2) return true;  // unknown
  const auto rise = [&](double time) {
    const std::size_t f = frame_at(time);
    return tracks_[foot.tracks.front()][f].y() - tracks_[foot.tracks.back()][f].y();
  };
  return rise(seed) - rise(seed - kFlatBefore * foot.cycle) > kPitched * leg_;
}

bool WalkingFeet::runs(double time) const {
  const double speed = speeds_[frame_at(time)];
  const Carriage here = carriage(time);
  const double fastest = here == Carriage::vaults ? kFastest : kRun;
  return here == Carriage::bounces || speed * speed > fastest * kGravity * leg_;
}

void WalkingFeet::to_landings(Foot& foot) const {
  const int frames = clip_.frame_count();
  const auto slowest = [&](int frame) { return slowest_of(foot, frame); };
  const int reach = static_cast<int>(kLandingWithin * clip_.rate) + 1;
  for (std::size_t i = 0; i < foot.stances.size(); ++i) {
    Stance& stance = foot.stances[i];
    const double middle = 0.5 * (stance.start + stance.end);
    const double speed = speeds_[frame_at(middle)];
    const bool backward = forward_[frame_at(middle)] < 0;
    const bool run = runs(middle) && speed * speed >= kJog * kGravity * leg_;
    if (!run && (!backward || stance.slides)) continue;
    double fastest = 0;
    const int cycle = static_cast<int>(foot.cycle * clip_.rate);
    const int around = static_cast<int>(frame_at(middle));
    for (int f = std::max(0, around - cycle); f < std::min(frames, around + cycle); ++f) {
      fastest = std::max(fastest, slowest(f));
    }
    const double slow = (run ? kLanding : kDragged) * fastest;
    if (!stance.open_start && run) {
      const int first = static_cast<int>(std::ceil(stance.start * clip_.rate));
      int f = first;
      // A sprinter's foot still travels where its contact begins: it lands as it slows down.
      while (f < std::min(frames - 1, first + reach) && slowest(f) > slow) ++f;
      while (f > std::max(0, first - reach - 1) && slowest(f - 1) <= slow) --f;
      const double before = i == 0 ? 0 : foot.stances[i - 1].end;
      if (f > std::max(0, first - reach - 1) && slowest(f) <= slow) {
        const double landed = crossed_at(slowest, f, f - 1, slow) / clip_.rate;
        if (landed > before && landed < stance.end) stance.start = landed;
      }
    }
    if (!stance.open_end) {
      const int last = static_cast<int>(std::ceil(stance.end * clip_.rate)) + reach;
      int f = static_cast<int>(stance.end * clip_.rate);
      while (f < std::min(frames - 1, last) && slowest(f + 1) <= slow) ++f;
      const double after =
          i + 1 == foot.stances.size() ? clip_.duration() : foot.stances[i + 1].start;
      if (f < std::min(frames - 1, last)) {
        const double left = crossed_at(slowest, f, f + 1, slow) / clip_.rate;
        if (left < after) stance.end = std::max(stance.end, left);
      }
    }
  }
}

bool WalkingFeet::rolls_off(const Foot& foot, double seed) const {
  if (runs(seed)) return false;
  return forward_[frame_at(seed)] > 0 && stays_level(foot, seed) && is_pitched(foot, seed);
}

double WalkingFeet::toes_reach(const Foot& foot, int frame) const {
  const auto f = static_cast<std::size_t>(frame);
  return directions_[f].dot(tracks_[foot.tracks.back()][f] - pelvis_[f]);
}

double WalkingFeet::toes_back(const Foot& foot, double seed) const {
  const auto reach = static_cast<int>(kTurnsWithin * clip_.rate);
  const auto middle = static_cast<int>(frame_at(seed));
  int back = middle;
  for (int f = std::max(0, middle - reach); f <= std::min(clip_.frame_count() - 1, middle + reach);
       ++f) {
    if (toes_reach(foot, f) < toes_reach(foot, back)) back = f;
  }
  if (back == 0 || back + 1 >= clip_.frame_count()) return back / clip_.rate;
  // The minimum of the parabola through three frames.
  const double before = toes_reach(foot, back - 1), after = toes_reach(foot, back + 1);
  const double bend = before + after - 2 * toes_reach(foot, back);
  const double part = bend > 0 ? 0.5 * (before - after) / bend : 0;
  return (back + std::clamp(part, -0.5, 0.5)) / clip_.rate;
}

}  // namespace krok::contacts
