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
constexpr double kFlat = 0.003;        // leg lengths, rise of the pelvis over a step
constexpr double kFlatBefore = 0.35;   // cycles, from flat foot to toe-off
constexpr double kPitched = 0.06;      // leg lengths, heel above toes
constexpr double kTurnsWithin = 0.15;  // seconds, of the toes around the foot's back seed

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

WalkingFeet::Carriage WalkingFeet::carriage() const {
  int more = 0;
  for (const Foot& foot : feet_) {
    for (const double seed : foot.seeds.back) {
      const double rise = rise_over(foot, seed);
      if (std::abs(rise) > kFlat * leg_) more += rise > 0 ? 1 : -1;
    }
  }
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

bool WalkingFeet::rolls_off(const Foot& foot, double seed) const {
  const double speed = speeds_[frame_at(seed)];
  const double fastest = carriage_ == Carriage::vaults ? kFastest : kRun;
  if (carriage_ == Carriage::bounces || speed * speed > fastest * kGravity * leg_) return false;
  return forward_[frame_at(seed)] != 0 && stays_level(foot, seed) && is_pitched(foot, seed);
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
