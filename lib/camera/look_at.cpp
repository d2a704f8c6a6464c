#include "camera/look_at.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "filter/smooth_clip.h"
#include "math/quaternion.h"

namespace krok {

namespace {

const double kSineAtVertical = std::sin(0.1 * kRadiansPerDegree);

// The unit direction from eye to target, if defined.
std::optional<Vec3> direction(const Vec3& eye, const Vec3& target) {
  const Vec3 way = target - eye;
  const double length = way.stableNorm();
  // Closer than this, rounding errors decide the direction.
  const double least = 1e-12 * (eye.stableNorm() + target.stableNorm());
  if (!(length > least) || !std::isfinite(length)) return std::nullopt;
  return Vec3(way / length);
}

bool is_vertical(const Vec3& forward) {
  return std::hypot(forward.x(), forward.z()) < kSineAtVertical;
}

Quat level(const Vec3& forward) {
  Mat3 axes;
  axes.col(0) = forward.cross(Vec3::UnitY()).normalized();
  axes.col(1) = axes.col(0).cross(forward);
  axes.col(2) = -forward;
  return Quat(axes).normalized();
}

Quat turned_to(const Vec3& forward, const Quat& before) {
  return normalized_or_identity(shortest_arc(before * Vec3(-Vec3::UnitZ()), forward) * before);
}

// The `before` of the first time, for a camera that starts out looking straight up or down.
Quat first_past(std::span<const Vec3> eyes, std::span<const Vec3> targets) {
  std::optional<Vec3> vertical;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    const auto forward = direction(eyes[i], targets[i]);
    if (!forward) continue;
    if (!is_vertical(*forward)) return level(*forward);
    if (!vertical) vertical = forward;
  }
  if (!vertical) return Quat::Identity();
  return looking_from(0, vertical->y() < 0 ? kPi / 2 : -kPi / 2);
}

}  // namespace

Quat look_at(const Vec3& eye, const Vec3& target, const Quat& before) {
  const auto forward = direction(eye, target);
  if (!forward) return before;
  return is_vertical(*forward) ? turned_to(*forward, before) : level(*forward);
}

std::vector<Quat> look_at(std::span<const Vec3> eyes, std::span<const Vec3> targets) {
  assert(eyes.size() == targets.size());
  std::vector<Quat> orientations;
  orientations.reserve(eyes.size());
  Quat before = first_past(eyes, targets);
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    before = look_at(eyes[i], targets[i], before);
    orientations.push_back(before);
  }
  return orientations;
}

Quat looking_from(double azimuth, double elevation) {
  return axis_rotation(Axis::y, azimuth) * axis_rotation(Axis::x, -elevation);
}

Quat rolled(const Quat& orientation, double angle) {
  return orientation * axis_rotation(Axis::z, -angle);
}

namespace {

// After kMemory * time, less than a thousandth of the initial state remains.
constexpr double kMemory = 5;

void run(std::span<double> series, double step, double time) {
  SpringState state{series.front(), 0};
  double from = series.front();
  for (double& value : series) {
    const double to = value;
    state = follow(state, from, to, step, time);
    from = to;
    value = state.value;
  }
}

}  // namespace

SpringState follow(const SpringState& state, double from, double to, double step, double time) {
  if (!(step > 0)) return state;
  const double slope = (to - from) / step;
  if (!(time > 0)) return {to, slope};
  const double w = 2 / time;
  // For constant velocity the steady state is from + slope (t - time); the deviation from it decays
  // as (a + b t) exp(-w t).
  const double a = state.value - from + slope * time;
  const double b = state.velocity - slope + w * a;
  const double left = std::exp(-w * step);
  return {to - slope * time + (a + b * step) * left, slope + (b - w * (a + b * step)) * left};
}

void smooth_both_ways(std::span<double> series, double rate, double time) {
  if (series.size() < 2 || !(time > 0) || !(rate > 0)) return;
  const std::size_t size = series.size();
  const auto padding = static_cast<std::size_t>(
      std::min(std::ceil(kMemory * time * rate), static_cast<double>(size - 1)));
  std::vector<double> longer;
  longer.reserve(size + 2 * padding);
  for (std::size_t i = padding; i > 0; --i) longer.push_back(2 * series.front() - series[i]);
  longer.insert(longer.end(), series.begin(), series.end());
  for (std::size_t i = 1; i <= padding; ++i) {
    longer.push_back(2 * series.back() - series[size - 1 - i]);
  }
  for (int way = 0; way < 2; ++way) {
    run(longer, 1 / rate, time);
    std::ranges::reverse(longer);
  }
  std::copy_n(longer.begin() + static_cast<std::ptrdiff_t>(padding), size, series.begin());
}

void smooth_both_ways(std::span<Vec3> series, double rate, double time) {
  filter::smooth_positions(
      [rate, time](std::span<double> values) { smooth_both_ways(values, rate, time); }, series);
}

}  // namespace krok
