#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "lint/soles_internal.h"

namespace krok::lint {

namespace {

constexpr double kNear = 0.03;       // metres above the support, of points that may carry
constexpr double kRising = 0.25;     // metres per second; faster up or down is a step
constexpr double kFastest = 1.7;     // metres per second; faster is a swing, not a slide
constexpr double kSpeedTime = 0.07;  // seconds over which speeds are measured
constexpr double kStepFactor = 2;    // times the slowest speed
constexpr double kStepSpeed = 0.1;   // metres per second, added to it
constexpr double kStanding = 0.45;   // of the legs' length, of hips over a foot that carries
constexpr double kKnees = 0.85;      // of the same; less is a bent leg
constexpr double kLean = 0.7;        // of a bent leg's height, its length along the ground
constexpr double kOffFloor = 0.1;    // metres over the lowest contact

std::vector<Vec3> velocities_of(const std::vector<Vec3>& places, double rate) {
  const int frames = static_cast<int>(places.size());
  const int reach = std::max(1, static_cast<int>(std::lround(kSpeedTime * rate / 2)));
  std::vector<Vec3> velocities(places.size());
  for (int f = 0; f < frames; ++f) {
    const int a = std::max(0, f - reach), b = std::min(frames - 1, f + reach);
    const Vec3 moved = places[at(b)] - places[at(a)];
    velocities[at(f)] = b > a ? Vec3(moved * (rate / (b - a))) : Vec3::Zero();
  }
  return velocities;
}

// How much of the way from a point to one that is higher is near the support.
double low_part(double height, double other, double limit) {
  return other <= limit ? 1 : std::clamp((limit - height) / (other - height), 0.0, 1.0);
}

std::array<int, 2> carrying(const Series& series, Soles& soles, int frame) {
  std::array<int, 2> slowest = {-1, -1};
  const double near = kNear * series.scale;
  const int tracks = static_cast<int>(soles.places.size());
  const auto velocity = [&](int track) { return level(soles.velocities[at(track)][at(frame)]); };
  const auto height = [&](int track) { return soles.found.tracks[at(track)].height[at(frame)]; };
  for (int t = 0; t < tracks; ++t) {
    if (height(t) > near ||
        std::abs(soles.velocities[at(t)][at(frame)].y()) > kRising * series.scale ||
        velocity(t).norm() > kFastest * series.scale || !stands(series, soles, t, frame)) {
      continue;
    }
    int& best = slowest[soles.side(t)];
    if (best < 0 || velocity(t).norm() < velocity(best).norm()) best = t;
  }
  for (const int best : slowest) {
    if (best < 0) continue;
    Vec3& slip = soles.slips[at(frame)][soles.side(best)] = velocity(best);
    for (int t = 0; t < tracks; ++t) {
      if (soles.side(t) != soles.side(best)) continue;
      const Vec3 turning =
          shortest_between(velocity(best), velocity(t), low_part(height(best), height(t), near));
      if (turning.squaredNorm() < slip.squaredNorm()) slip = turning;
    }
    const auto& of_ankle = soles.ankle_velocities[soles.side(best)];
    if (!of_ankle.empty()) slip = shortest_between(slip, level(of_ankle[at(frame)]));
  }
  return slowest;
}

// [frames]: whether a foot on the ground still slows down, or already speeds up, at the beginning
// or end of a stance.
std::vector<char> step_ends(const Series& series, const Soles& soles, std::size_t side) {
  const int shortest = series.frames_in(kStepEnd, 1),
            longest = series.frames_in(kLongestStepEnd, shortest);
  const auto foot = [&](int f) { return soles.carrying[at(f)][side]; };
  std::vector<char> ends_here(at(series.frames), 0);
  for (const auto& [first, end] : runs_of(series.frames, [&](int f) { return foot(f) >= 0; })) {
    for (const int step : {1, -1}) {
      if (step > 0 ? first == 0 : end == series.frames) continue;
      const int begin = step > 0 ? first : end - 1, count = std::min(longest, end - first);
      const auto speed = [&soles, &foot, begin, step](int k) {
        const int f = begin + step * k;
        return soles.speed(foot(f), f);
      };
      int slowest = 0, ends = std::min(shortest, count);
      for (int k = 1; k < count; ++k) slowest = speed(k) < speed(slowest) ? k : slowest;
      const double limit = kStepFactor * speed(slowest) + kStepSpeed * series.scale;
      for (int k = ends; k < slowest; ++k) ends = speed(k) > limit ? k + 1 : ends;
      for (int k = 0; k < ends; ++k) ends_here[at(begin + step * k)] = 1;
    }
  }
  return ends_here;
}

// The joint of each foot none of whose points a joint marks.
void add_ankles(const Series& series, Soles& soles) {
  std::array<const SolePoint*, 2> unmarked = {nullptr, nullptr};
  std::array<bool, 2> marked = {false, false};
  for (const PointTrack& track : soles.found.tracks) {
    const auto side = static_cast<std::size_t>(track.point.side);
    marked[side] = marked[side] || !track.point.estimated;
    if (unmarked[side] == nullptr) unmarked[side] = &track.point;
  }
  for (const std::size_t side : {0, 1}) {
    if (marked[side] || unmarked[side] == nullptr) continue;
    const SolePoint& point = *unmarked[side];
    soles.ankles[side] =
        track_of(series.clip, {point.side, point.part, point.joint}, soles.found.leg_length);
    soles.ankle_velocities[side] = velocities_of(soles.ankles[side], series.rate);
  }
}

}  // namespace

bool stands(const Series& series, const Soles& soles, int track, int frame) {
  const Vec3 hips = series.clip.frame_positions(frame)[at(series.carrier)].cast<double>();
  const Vec3 leg = hips - soles.places[at(track)][at(frame)];
  if (leg.y() < kStanding * soles.found.leg_length) return false;
  if (leg.y() > kKnees * soles.found.leg_length) return true;
  return std::hypot(leg.x(), leg.z()) < kLean * leg.y() &&
         hips.y() - leg.y() < soles.floor + kOffFloor * series.scale;
}

Vec3 shortest_between(const Vec3& a, const Vec3& b, double part) {
  const Vec3 way = b - a;
  const double square = way.squaredNorm();
  return square > 0 ? Vec3(a + std::clamp(-a.dot(way) / square, 0.0, part) * way) : a;
}

std::optional<Soles> soles_of(const Series& series) {
  auto found = find_contacts(series.clip, series.roles);
  if (!found) return std::nullopt;
  Soles soles;
  soles.found = *std::move(found);
  for (const PointTrack& track : soles.found.tracks) {
    soles.places.push_back(track_of(series.clip, track.point, soles.found.leg_length));
    soles.velocities.push_back(velocities_of(soles.places.back(), series.rate));
  }
  add_ankles(series, soles);
  for (const Stay& stay : soles.found.stays) {
    soles.floor = std::min(soles.floor, stay.place.y());
  }
  soles.slips.assign(at(series.frames), {Vec3::Zero(), Vec3::Zero()});
  for (int f = 0; f < series.frames; ++f) soles.carrying.push_back(carrying(series, soles, f));
  const std::array<std::vector<char>, 2> ends = {step_ends(series, soles, 0),
                                                 step_ends(series, soles, 1)};
  for (int f = 0; f < series.frames; ++f) {
    const auto& [left, right] = soles.carrying[at(f)];
    int slower = std::max(left, right);
    if (left >= 0 && right >= 0) {
      slower = soles.speed(right, f) < soles.speed(left, f) ? right : left;
    }
    soles.bearing.push_back(slower >= 0 && ends[soles.side(slower)][at(f)] == 0 ? slower : -1);
  }
  return soles;
}

void find_foot_faults(const Series& series, MotionFaults& out) {
  const bool slides = series.has(Rule::foot_slide) || series.has(Rule::drift);
  if (!slides && !series.has(Rule::ground)) return;
  const auto soles = soles_of(series);
  if (!soles) return;
  if (slides && !series.options.treadmill) find_slides(series, *soles, out);
  if (series.has(Rule::ground)) find_ground_faults(series, *soles, out);
}

}  // namespace krok::lint
