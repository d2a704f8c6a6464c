#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "math/hermite.h"
#include "math/quaternion.h"
#include "nodes/evaluate.h"
#include "nodes/scene_of.h"

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

namespace {

constexpr int kSplineParts = 4;
constexpr int kMaxParts = 64;
constexpr double kTurnOfPart = 15 * kRadiansPerDegree;
constexpr double kLargeTurn = 90 * kRadiansPerDegree;

// The values of a key, without its tangents.
std::span<const float> value_of(const Channel& channel, std::size_t key) {
  const auto width = static_cast<std::size_t>(channel.width);
  const bool spline = channel.interpolation == Interpolation::cubic_spline;
  return {channel.values->data() + width * (spline ? 3 * key + 1 : key), width};
}

bool equal(std::span<const float> a, std::span<const float> b) {
  return std::equal(a.begin(), a.end(), b.begin());
}

// Whether a channel keeps its value from a key to the next.
bool rests(const Channel& channel, std::size_t key) {
  if (!equal(value_of(channel, key), value_of(channel, key + 1))) return false;
  if (channel.interpolation != Interpolation::cubic_spline) return true;
  const auto width = static_cast<std::size_t>(channel.width);
  // The out-tangent of this key and the in-tangent of the next are neighbours.
  const std::span<const float> tangents(channel.values->data() + width * (3 * key + 2), 2 * width);
  return std::all_of(tangents.begin(), tangents.end(), [](float value) { return value == 0; });
}

Quat turn_at(const Channel& channel, double time) {
  std::array<double, 4> value;
  sample(channel, time, value);
  return {value[3], value[0], value[1], value[2]};
}

// How far a rotation turns from a key to the next.
double turn_of(const Channel& channel, std::size_t key) {
  const double begin = static_cast<double>((*channel.times)[key]);
  const double length = static_cast<double>((*channel.times)[key + 1]) - begin;
  const int parts = channel.interpolation == Interpolation::cubic_spline ? 16 : 1;
  double turn = 0;
  Quat last = turn_at(channel, begin);
  for (int part = 1; part <= parts; ++part) {
    const Quat next = turn_at(channel, begin + length * part / parts);
    turn += angle_between(last, next);
    last = next;
  }
  return turn;
}

KeyGap gap_of(const Channel& channel, std::size_t key) {
  if (rests(channel, key)) return {};
  if (channel.interpolation == Interpolation::step) return {1, true};
  const bool spline = channel.interpolation == Interpolation::cubic_spline;
  const double turn = channel.path == Path::rotation ? turn_of(channel, key) : 0;
  if (!spline) return {turn > kLargeTurn ? kSplineParts : 1, false};
  const double parts = std::ceil(std::min<double>(turn / kTurnOfPart, kMaxParts));
  return {std::max(kSplineParts, static_cast<int>(parts)), false};
}

}  // namespace

std::vector<KeyGap> key_gaps(const Animation& animation, std::span<const double> times) {
  std::vector<KeyGap> gaps(times.empty() ? 0 : times.size() - 1);
  for (const Channel& channel : animation.channels) {
    std::size_t at = 0;
    for (std::size_t key = 0; key + 1 < channel.times->size(); ++key) {
      const KeyGap gap = gap_of(channel, key);
      const double end = static_cast<double>((*channel.times)[key + 1]);
      while (at < gaps.size() && times[at] < static_cast<double>((*channel.times)[key])) ++at;
      for (; at < gaps.size() && times[at] < end; ++at) {
        gaps[at].parts = std::max(gaps[at].parts, gap.parts);
        gaps[at].jumps = gaps[at].jumps || (gap.jumps && times[at + 1] >= end);
      }
    }
  }
  if (std::ranges::all_of(gaps, [](const KeyGap& gap) { return gap == KeyGap(); })) gaps.clear();
  return gaps;
}

std::string interpolation_words(const Animation& animation) {
  std::array<bool, 3> found{};
  for (const Channel& channel : animation.channels) {
    for (std::size_t key = 0; key + 1 < channel.times->size(); ++key) {
      if (rests(channel, key)) continue;
      found[static_cast<std::size_t>(channel.interpolation)] = true;
      break;
    }
  }
  constexpr std::array kWords = {"linear", "step", "cubic spline"};
  std::vector<std::string> words;
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    if (found[i]) words.emplace_back(kWords[i]);
  }
  return words.empty() ? "no" : fmt::format("{}", fmt::join(words, " and "));
}

}  // namespace krok::nodes
