#include "math/hermite.h"

#include <cassert>
#include <cmath>
#include <vector>

namespace krok {

namespace {

template <typename Value>
Value cubic(const Value& p0, const Value& v0, const Value& p1, const Value& v1, double span,
            double t) {
  const double t2 = t * t;
  const double t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * p0 + (span * (t3 - 2 * t2 + t)) * v0 + (3 * t2 - 2 * t3) * p1 +
         (span * (t3 - t2)) * v1;
}

template <typename Value>
Value cubic_velocity(const Value& p0, const Value& v0, const Value& p1, const Value& v1,
                     double span, double t) {
  const double t2 = t * t;
  return (6 * (t2 - t) / span) * (p0 - p1) + (3 * t2 - 4 * t + 1) * v0 + (3 * t2 - 2 * t) * v1;
}

// Calls inner(key, before, after, span_before, span_after) with the differences to both neighbours
// of each key, which depend on `ends`, and end(key) at open ends.
template <typename Value, typename Inner, typename End>
void each_key(std::span<const double> times, std::span<const Value> values, Ends ends,
              const Inner& inner, const End& end) {
  const std::size_t last = times.size() - 1;
  for (std::size_t i = 1; i < last; ++i) {
    inner(i, values[i] - values[i - 1], values[i + 1] - values[i], times[i] - times[i - 1],
          times[i + 1] - times[i]);
  }
  if (ends == Ends::open) {
    end(std::size_t{0});
    end(last);
    return;
  }
  for (const std::size_t i : {std::size_t{0}, last}) {
    inner(i, values[last] - values[last - 1], values[1] - values[0], times[last] - times[last - 1],
          times[1] - times[0]);
  }
}

template <typename Value>
void set_tension_velocities(std::span<const double> times, std::span<const Value> values,
                            double tension, Ends ends, std::span<Value> velocities,
                            const Value& zero) {
  assert(times.size() == values.size() && times.size() == velocities.size());
  if (times.size() < 2) {
    std::ranges::fill(velocities, zero);
    return;
  }
  const double share = 1 - tension;
  each_key<Value>(
      times, values, ends,
      [&](std::size_t i, const Value& before, const Value& after, double span_before,
          double span_after) {
        velocities[i] = (share / (span_before + span_after)) * (before + after);
      },
      [&](std::size_t i) {
        const std::size_t from = i == 0 ? 0 : i - 1;
        velocities[i] =
            (share / (times[from + 1] - times[from])) * (values[from + 1] - values[from]);
      });
}

// The slope at a key from those on both sides: 0 if their signs differ, otherwise their harmonic
// mean, weighted towards the shorter side.
double monotone_slope(double slope_before, double slope_after, double span_before,
                      double span_after) {
  if (!(slope_before * slope_after > 0)) return 0;
  const double weight_before = 2 * span_after + span_before;
  const double weight_after = span_after + 2 * span_before;
  return (weight_before + weight_after) /
         (weight_before / slope_before + weight_after / slope_after);
}

// The slope at an end: that of the parabola through three keys, limited to keep the cubic monotone.
double monotone_end_slope(double near_slope, double far_slope, double near_span, double far_span) {
  const double slope =
      ((2 * near_span + far_span) * near_slope - near_span * far_slope) / (near_span + far_span);
  if (!(slope * near_slope > 0)) return 0;
  const bool turns = !(near_slope * far_slope > 0);
  return turns && std::abs(slope) > 3 * std::abs(near_slope) ? 3 * near_slope : slope;
}

template <typename Value>
Value value_at(std::span<const double> times, std::span<const Value> values,
               std::span<const Value> velocities, double time) {
  assert(!times.empty() && times.size() == values.size() && times.size() == velocities.size());
  if (!(time > times.front())) return values.front();
  if (time >= times.back()) return values.back();
  const std::size_t k = key_before(times, time);
  if (time == times[k]) return values[k];
  const double span = times[k + 1] - times[k];
  return cubic(values[k], velocities[k], values[k + 1], velocities[k + 1], span,
               (time - times[k]) / span);
}

}  // namespace

double hermite(double p0, double v0, double p1, double v1, double span, double t) {
  return cubic(p0, v0, p1, v1, span, t);
}
Vec3 hermite(const Vec3& p0, const Vec3& v0, const Vec3& p1, const Vec3& v1, double span,
             double t) {
  return cubic(p0, v0, p1, v1, span, t);
}

double hermite_velocity(double p0, double v0, double p1, double v1, double span, double t) {
  return cubic_velocity(p0, v0, p1, v1, span, t);
}
Vec3 hermite_velocity(const Vec3& p0, const Vec3& v0, const Vec3& p1, const Vec3& v1, double span,
                      double t) {
  return cubic_velocity(p0, v0, p1, v1, span, t);
}

void tension_velocities(std::span<const double> times, std::span<const double> values,
                        double tension, Ends ends, std::span<double> velocities) {
  set_tension_velocities(times, values, tension, ends, velocities, 0.0);
}
void tension_velocities(std::span<const double> times, std::span<const Vec3> values, double tension,
                        Ends ends, std::span<Vec3> velocities) {
  set_tension_velocities<Vec3>(times, values, tension, ends, velocities, Vec3::Zero());
}

void monotone_velocities(std::span<const double> times, std::span<const double> values, Ends ends,
                         std::span<double> velocities) {
  assert(times.size() == values.size() && times.size() == velocities.size());
  if (times.size() < 2) {
    std::ranges::fill(velocities, 0.0);
    return;
  }
  const std::size_t last = times.size() - 1;
  const auto span = [&](std::size_t i) { return times[i + 1] - times[i]; };
  const auto slope = [&](std::size_t i) { return (values[i + 1] - values[i]) / span(i); };
  each_key<double>(
      times, values, ends,
      [&](std::size_t i, double before, double after, double span_before, double span_after) {
        velocities[i] =
            monotone_slope(before / span_before, after / span_after, span_before, span_after);
      },
      [&](std::size_t i) {
        if (last == 1) {
          velocities[i] = slope(0);
          return;
        }
        const std::size_t near = i == 0 ? 0 : last - 1;
        const std::size_t far = i == 0 ? 1 : last - 2;
        velocities[i] = monotone_end_slope(slope(near), slope(far), span(near), span(far));
      });
}

void monotone_velocities(std::span<const double> times, std::span<const Vec3> values, Ends ends,
                         std::span<Vec3> velocities) {
  std::vector<double> coordinate(values.size()), result(values.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < values.size(); ++i) coordinate[i] = values[i][axis];
    monotone_velocities(times, coordinate, ends, result);
    for (std::size_t i = 0; i < values.size(); ++i) velocities[i][axis] = result[i];
  }
}

double sample_curve(std::span<const double> times, std::span<const double> values,
                    std::span<const double> velocities, double time) {
  return value_at(times, values, velocities, time);
}
Vec3 sample_curve(std::span<const double> times, std::span<const Vec3> values,
                  std::span<const Vec3> velocities, double time) {
  return value_at(times, values, velocities, time);
}

std::size_t key_before(std::span<const double> times, double time, std::size_t guess) {
  assert(!times.empty());
  const std::size_t last = times.size() - 1;
  // Tries a few steps forwards or one back from `guess`, then a binary search.
  constexpr std::size_t kSteps = 4;
  std::size_t k = std::min(guess, last);
  if (k > 0 && time < times[k]) --k;
  if (!(time < times[k])) {
    for (std::size_t step = 0; step < kSteps; ++step, ++k) {
      if (k == last || time < times[k + 1]) return k;
    }
  }
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  return after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
}

}  // namespace krok
