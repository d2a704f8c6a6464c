#include <algorithm>
#include <cmath>
#include <limits>

#include "character/sampling.h"
#include "core/numbers.h"
#include "formats/assimp/curve_internal.h"
#include "math/quaternion.h"

namespace krok::assimp {

namespace {

// The parameter at which a Bezier curve from 0 to 1 with inner points a and b, in [0, 1], is at x.
double bezier_parameter(double a, double b, double x) {
  if (std::abs(a - 1.0 / 3) + std::abs(b - 2.0 / 3) < 1e-6) return x;
  double low = 0, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double s = (low + high) / 2, r = 1 - s;
    (3 * r * s * (r * a + s * b) + s * s * s > x ? high : low) = s;
  }
  return (low + high) / 2;
}

bool is_usable(const Curve& curve) {
  const std::size_t keys = curve.times.size();
  if (keys == 0 || keys != curve.values.size() || keys != curve.segments.size() + 1) return false;
  for (std::size_t k = 0; k < keys; ++k) {
    if (!std::isfinite(curve.values[k]) || !(std::abs(curve.times[k]) < 1e9)) return false;
    if (k == 0) continue;
    const Segment& segment = curve.segments[k - 1];
    const bool later = static_cast<float>(curve.times[k]) > static_cast<float>(curve.times[k - 1]);
    if (!later || !segment.out.allFinite() || !segment.in.allFinite()) return false;
  }
  return true;
}

bool is_step(const Segment& segment) {
  return segment.shape == Shape::hold || segment.shape == Shape::hold_next;
}

// How far beside a jump its second key is: another float, but the same to distinct_key_times().
double beside(double time) {
  return 6e-7 + 1.5e-7 * std::abs(time);
}

struct Frames {
  double start = 0, rate = 60, longest = 0;

  // Whether linear interpolation from key k to the next may be wrong.
  bool is_open(const Curve& curve, std::size_t k) const {
    const Segment& segment = curve.segments[k];
    const double value = curve.values[k];
    if (curve.times[k + 1] - curve.times[k] < longest || is_step(segment)) return false;
    const bool moves = curve.values[k + 1] != value;
    if (segment.shape == Shape::linear) return moves && curve.turns;
    return moves || segment.out[1] != value || segment.in[1] != value;
  }

  // Calls `use` with the ends of each frame, or part of one, of gap k if it is open.
  template <typename Use>
  void for_each(const Curve& curve, std::size_t k, Use use) const {
    constexpr double kMargin = 0.02;  // frames
    if (!is_open(curve, k)) return;
    double before = curve.times[k];
    const double end = curve.times[k + 1], last = (end - start) * rate - kMargin;
    for (double f = std::floor((before - start) * rate + kMargin) + 1; f < last; ++f) {
      use(before, start + f / rate);
      before = start + f / rate;
    }
    use(before, end);
  }
  template <typename Use>
  void for_each(const Curve& curve, Use use) const {
    for (std::size_t k = 0; k < curve.segments.size(); ++k) for_each(curve, k, use);
  }

  double new_keys(const CurveSet& set) const {
    double seconds = 0;
    for (const Curve& curve : set.curves) {
      for (std::size_t k = 0; k < curve.segments.size(); ++k) {
        if (is_open(curve, k)) seconds += curve.times[k + 1] - curve.times[k];
      }
    }
    return seconds * rate;
  }
};

Quat rotation(const CurveSet& set, const std::vector<Turn>& turns, double time) {
  Quat product = Quat::Identity();
  for (const Turn& turn : turns) {
    const double degrees =
        turn.curve < 0 ? turn.degrees : set.curves[static_cast<std::size_t>(turn.curve)].at(time);
    product = product * Quat(Eigen::AngleAxisd(degrees * kRadiansPerDegree, turn.axis));
  }
  return product;
}

// Of what linear interpolation gives, in the middle of each frame; of a whole gap, if there are no
// frames, also beside it, where curves of the shape of an S deviate.
void measure(const Frames& frames, CurveSet& set) {
  set.result = {.rate = frames.rate, .gap = set.result.gap};
  const auto parts = frames.rate > 0 ? std::vector{0.5} : std::vector{0.25, 0.5, 0.75};
  for (const Curve& curve : set.curves) {
    // Of weights and scales it is enough to know whether they deviate at all.
    const double metres = curve.metres > 0 || frames.rate > 0 ? curve.metres : 1;
    if (metres == 0 || curve.turns) continue;
    frames.for_each(curve, [&](double a, double b) {
      for (const double part : parts) {
        const double off =
            std::lerp(curve.at(a), curve.at(b), part) - curve.at(std::lerp(a, b, part));
        set.result.metres = std::max(set.result.metres, metres * std::abs(off));
      }
    });
  }
  for (const auto& turns : set.rotations) {
    const auto check = [&](double a, double b) {
      const double edge = beside(b);  // off the jumps of other axes
      if (b - a < std::max(4 * edge, frames.rate > 0 ? 0.0 : frames.longest)) return;
      const Quat begin = rotation(set, turns, a + edge), end = rotation(set, turns, b - edge);
      for (const double part : parts) {
        const Quat own = rotation(set, turns, std::lerp(a, b, part));
        const double off = angle_between(slerp(begin, end, part), own) / kRadiansPerDegree;
        set.result.degrees = std::max(set.result.degrees, off);
      }
    };
    for (const Turn& turn : turns) {
      if (turn.curve < 0) continue;
      frames.for_each(set.curves[static_cast<std::size_t>(turn.curve)], [&](double a, double b) {
        std::vector<double> times = {a, b};  // and the keys of the other axes
        for (const Turn& other : turns) {
          if (other.curve < 0) continue;
          const auto& keys = set.curves[static_cast<std::size_t>(other.curve)].times;
          times.insert(times.end(), std::ranges::upper_bound(keys, a),
                       std::ranges::lower_bound(keys, b));
        }
        std::ranges::sort(times);
        for (std::size_t k = 1; k < times.size(); ++k) check(times[k - 1], times[k]);
      });
    }
  }
}

void add_keys(const Frames& frames, Curve& curve) {
  std::vector<double> times, values;
  const auto add = [&](double time, double value) {
    times.push_back(time);
    values.push_back(value);
  };
  for (std::size_t k = 0; k < curve.segments.size(); ++k) {
    const double begin = curve.times[k], end = curve.times[k + 1], edge = beside(end);
    add(begin, curve.values[k]);
    frames.for_each(curve, k, [&](double, double time) {
      if (time < end) add(time, curve.at(time));
    });
    if (!is_step(curve.segments[k]) || end - begin < 4 * edge) continue;
    const bool next = curve.segments[k].shape == Shape::hold_next;
    add(next ? begin + edge : end - edge, curve.values[next ? k + 1 : k]);
  }
  add(curve.times.back(), curve.values.back());
  curve.changed = times.size() > curve.times.size();
  curve.times = std::move(times);
  curve.values = std::move(values);
}

}  // namespace

double Curve::at(double time) const {
  const auto after = std::ranges::upper_bound(times, time);
  if (after == times.begin()) return values.front();
  if (after == times.end()) return values.back();
  const auto k = static_cast<std::size_t>(after - times.begin()) - 1;
  const Segment& segment = segments[k];
  const double a = values[k], b = values[k + 1], length = times[k + 1] - times[k];
  const auto part = [&](double t) { return std::clamp((t - times[k]) / length, 0.0, 1.0); };
  if (is_step(segment)) return segment.shape == Shape::hold || part(time) == 0 ? a : b;
  if (segment.shape == Shape::linear) return a + part(time) * (b - a);
  const double s = bezier_parameter(part(segment.out[0]), part(segment.in[0]), part(time));
  const double r = 1 - s;
  return r * r * r * a + 3 * r * s * (r * segment.out[1] + s * segment.in[1]) + s * s * s * b;
}

void resample(CurveSet& set) {
  constexpr double kMaxKeys = 1e6;
  std::vector<double> times;
  for (Curve& curve : set.curves) {
    if (is_usable(curve)) {
      times.insert(times.end(), curve.times.begin(), curve.times.end());
      continue;
    }
    for (std::size_t k = 1; k < curve.times.size(); ++k) {
      set.result.gap = std::max(set.result.gap, curve.times[k] - curve.times[k - 1]);
    }
    curve = {.times = {0}, .values = {0}};  // without gaps
  }
  if (times.empty()) return;
  for (const auto& turns : set.rotations) {
    for (const Turn& turn : turns) {
      if (turn.curve >= 0) set.curves[static_cast<std::size_t>(turn.curve)].turns = true;
    }
  }
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  Frames frames{.start = times.front(), .rate = character::common_grid(times).value_or(60)};
  frames.longest = 1.5 / frames.rate;
  while (frames.new_keys(set) > kMaxKeys) frames.rate /= 2;
  const double lowest = frames.rate;
  for (const double factor : {0, 1, 2, 4, 8}) {
    if (factor == 0 && set.pivots) continue;
    const Frames finer{.start = frames.start, .rate = factor * lowest, .longest = frames.longest};
    if (factor > 1 && finer.new_keys(set) > kMaxKeys) break;
    frames = finer;
    measure(frames, set);
    if (set.result.degrees <= kCurveDegrees && set.result.metres <= kCurveMetres) break;
  }
  set.result.frames = lowest;
  for (Curve& curve : set.curves) add_keys(frames, curve);
}

std::vector<std::string_view> words_of(std::string_view text) {
  constexpr std::string_view kBetween = " \t\r\n,";
  std::vector<std::string_view> words;
  for (std::size_t at = text.find_first_not_of(kBetween); at < text.size();
       at = text.find_first_not_of(kBetween, at)) {
    const std::size_t end = std::min(text.find_first_of(kBetween, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

std::vector<double> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view word : words_of(text)) {
    numbers.push_back(parse_finite(word).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return numbers;
}

}  // namespace krok::assimp
