#include <algorithm>

#include "math/hermite.h"
#include "math/quaternion.h"
#include "nodes/evaluate.h"

namespace krok::nodes {

namespace {

// Cubic spline keys are stored as (in-tangent, value, out-tangent).
std::size_t value_offset(const Channel& channel, std::size_t key) {
  const auto width = static_cast<std::size_t>(channel.width);
  return channel.interpolation == Interpolation::cubic_spline ? (3 * key + 1) * width : key * width;
}

void copy_key(const Channel& channel, std::size_t key, std::span<double> values) {
  const float* from = channel.values->data() + value_offset(channel, key);
  std::copy(from, from + channel.width, values.begin());
}

void interpolate_spline(const Channel& channel, std::size_t key, double t, double span,
                        std::span<double> values) {
  const auto width = static_cast<std::size_t>(channel.width);
  const float* v0 = channel.values->data() + value_offset(channel, key);
  const float* out0 = v0 + width;
  const float* v1 = channel.values->data() + value_offset(channel, key + 1);
  const float* in1 = v1 - width;
  for (std::size_t i = 0; i < width; ++i) {
    values[i] = hermite(v0[i], out0[i], v1[i], in1[i], span, t);
  }
}

Quat quaternion(const float* xyzw) {
  return normalized_or_identity(Quat(static_cast<double>(xyzw[3]), static_cast<double>(xyzw[0]),
                                     static_cast<double>(xyzw[1]), static_cast<double>(xyzw[2])));
}

void interpolate_linear(const Channel& channel, std::size_t key, double t,
                        std::span<double> values) {
  const float* v0 = channel.values->data() + value_offset(channel, key);
  const float* v1 = channel.values->data() + value_offset(channel, key + 1);
  if (channel.path == Path::rotation) {
    const Quat q = slerp(quaternion(v0), quaternion(v1), t);
    std::copy(q.coeffs().begin(), q.coeffs().end(), values.begin());
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<double>(v0[i]) * (1 - t) + static_cast<double>(v1[i]) * t;
  }
}

}  // namespace

void sample(const Channel& channel, double time, std::span<double> values) {
  const std::vector<float>& times = *channel.times;
  const auto after = std::upper_bound(
      times.begin(), times.end(), time,
      [](double moment, float key_time) { return moment < static_cast<double>(key_time); });
  if (after == times.begin()) {
    copy_key(channel, 0, values);
  } else if (after == times.end() || channel.interpolation == Interpolation::step) {
    copy_key(channel, static_cast<std::size_t>(after - times.begin()) - 1, values);
  } else {
    const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
    const double begin = static_cast<double>(times[key]);
    const double span = static_cast<double>(*after) - begin;
    const double t = (time - begin) / span;
    if (channel.interpolation == Interpolation::cubic_spline) {
      interpolate_spline(channel, key, t, span, values);
    } else {
      interpolate_linear(channel, key, t, values);
    }
  }
  if (channel.path == Path::rotation) {
    const Quat q = normalized_or_identity(Quat(values[3], values[0], values[1], values[2]));
    std::copy(q.coeffs().begin(), q.coeffs().end(), values.begin());
  }
}

}  // namespace krok::nodes
