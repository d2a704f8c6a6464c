#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "math/window.h"
#include "plant/smooth_curve_internal.h"

namespace krok::plant {

namespace {

constexpr double kLowestCutoff = 4, kHighestCutoff = 20;  // Hz

// A symmetric matrix of five diagonals, positive definite.
struct Pentadiagonal {
  std::vector<double> main, first, second;  // first[i] couples i and i + 1

  explicit Pentadiagonal(std::size_t n) : main(n, 0), first(n, 0), second(n, 0) {}

  // Adds weight * (second difference at i)^2.
  void add_bend(std::size_t i, double weight) {
    main[i - 1] += weight;
    main[i] += 4 * weight;
    main[i + 1] += weight;
    first[i - 1] -= 2 * weight;
    first[i] -= 2 * weight;
    second[i - 1] += weight;
  }

  // Adds weight * (difference from i to i + 1)^2.
  void add_slope(std::size_t i, double weight) {
    main[i] += weight;
    main[i + 1] += weight;
    first[i] -= weight;
  }

  // Solves in place, by L D L^T.
  void solve(std::vector<Vec3>& values) {
    const std::size_t n = main.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double pivot = main[i];
      const double near = first[i] / pivot, far = second[i] / pivot;
      if (i + 1 < n) {
        main[i + 1] -= near * first[i];
        first[i + 1] -= near * second[i];
        values[i + 1] -= near * values[i];
      }
      if (i + 2 < n) {
        main[i + 2] -= far * second[i];
        values[i + 2] -= far * values[i];
      }
      first[i] = near;
      second[i] = far;
    }
    for (std::size_t i = n; i-- > 0;) {
      values[i] /= main[i];
      if (i + 1 < n) values[i] -= first[i] * values[i + 1];
      if (i + 2 < n) values[i] -= second[i] * values[i + 2];
    }
  }
};

// 1 at 0, 0 from 1 on, two derivatives continuous.
double fade_out(double u) {
  if (u >= 1) return 0;
  return 1 - u * u * u * (10 - 15 * u + 6 * u * u);
}

// The mean over `reach` frames on either side; ends stand for what is beyond.
std::vector<double> running_mean(std::span<const double> values, int reach) {
  const int n = static_cast<int>(values.size());
  std::vector<double> result(values.size());
  const auto at = [&](int i) { return values[static_cast<std::size_t>(std::clamp(i, 0, n - 1))]; };
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) sum += at(i);
  for (int i = 0; i < n; ++i) {
    result[static_cast<std::size_t>(i)] = sum / (2 * reach + 1);
    sum += at(i + reach + 1) - at(i - reach);
  }
  return result;
}

}  // namespace

namespace {

// The median size of the third differences of values known from frame to frame, by `size`. That of
// white noise has 1 + 9 + 9 + 1 = 20 times its variance, that of movement is small for most frames.
template <typename Size>
double median_third_difference(const KnownCurve& curve, const Size& size) {
  std::vector<double> differences;
  differences.reserve(curve.values.size());
  int known = 0;  // in a row
  for (std::size_t f = 0; f < curve.values.size(); ++f) {
    known = curve.is_exact(f) ? known + 1 : 0;
    if (known < 4) continue;
    const auto at = [&](std::size_t frame) -> const Vec3& { return curve.values[frame]; };
    differences.push_back(size(at(f) - 3 * at(f - 1) + 3 * at(f - 2) - at(f - 3)));
  }
  if (differences.empty()) return 0;
  const auto half = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), half, differences.end());
  return *half / std::sqrt(20.0);
}

}  // namespace

double height_jitter_of(const KnownCurve& curve) {
  // The median of |x| of a Gaussian is 0.6745 of its deviation.
  return median_third_difference(curve, [](const Vec3& v) { return std::abs(v.y()); }) / 0.6745;
}

double jitter_of(const KnownCurve& curve) {
  // The median length of two such, as on the ground whatever its axes, is sqrt(2 ln 2).
  const double level =
      median_third_difference(curve, [](const Vec3& v) { return std::hypot(v.x(), v.z()); }) /
      std::sqrt(2 * std::numbers::ln2);
  return std::hypot(level, level, height_jitter_of(curve)) / std::sqrt(3.0);
}

double cutoff_against(double deviation, double speed, double rate) {
  // White noise low-passed at c and differentiated keeps a variance of 2 (2 pi)^2 c^3 / (3 rate) of
  // its own on each of three axes.
  if (!(deviation > 0)) return kHighestCutoff;
  const double cutoff = std::cbrt(speed * speed * rate / (8 * kPi * kPi * deviation * deviation));
  return std::clamp(cutoff, kLowestCutoff, kHighestCutoff);
}

std::vector<Vec3> smooth_curve(const KnownCurve& curve, const CurveOptions& options) {
  const std::size_t n = curve.values.size();
  std::vector<Vec3> result(n, Vec3::Zero());
  if (std::ranges::count(curve.known, Known::no) == static_cast<long>(n)) return result;
  Pentadiagonal matrix(n);
  const double frames = 0.25 * options.fade * options.rate;
  const double bend = frames * frames * frames * frames;
  const double slope = bend / std::pow(std::max(0.5, options.tension * options.rate), 2);
  // A sine of frequency w keeps 1 / (1 + bend / weight * w^4) of itself.
  const double turn = 2 * std::sin(std::min(kPi * options.cutoff / options.rate, kPi / 2));
  const double weight = std::max(1.0, bend * turn * turn * turn * turn);
  for (std::size_t f = 0; f < n; ++f) {
    const bool known = curve.known[f] != Known::no;
    matrix.main[f] += known ? weight : 1;
    if (known) result[f] = weight * curve.values[f];
    if (f > 0 && f + 1 < n) matrix.add_bend(f, bend);
    if (f + 1 < n && (!known || curve.known[f + 1] == Known::no)) matrix.add_slope(f, slope);
  }
  matrix.solve(result);
  return result;
}

std::vector<Vec3> curve_through(const KnownCurve& curve, const CurveOptions& options) {
  std::vector<Vec3> result = smooth_curve(curve, options);
  const int n = static_cast<int>(result.size());
  const auto exact = [&](int f) { return curve.is_exact(static_cast<std::size_t>(f)); };
  const auto at = [](auto& list, int f) -> auto& {
    return list[static_cast<std::size_t>(f)];
  };
  const int reach = std::max(1, static_cast<int>(std::lround(options.join * options.rate)));
  std::vector<Vec3> rest(curve.values.size(), Vec3::Zero());
  for (int f = 0; f < n; ++f) {
    if (!exact(f)) continue;
    const Vec3 missing = at(curve.values, f) - at(result, f);
    for (const int step : {-1, 1}) {
      for (int i = 1; i < reach; ++i) {
        const int g = f + step * i;
        if (g < 0 || g >= n || exact(g)) break;
        at(rest, g) += fade_out(static_cast<double>(i) / reach) * missing;
      }
    }
  }
  for (int f = 0; f < n; ++f) {
    at(result, f) = exact(f) ? at(curve.values, f) : Vec3(at(result, f) + at(rest, f));
  }
  return result;
}

std::vector<double> smooth_above(std::span<const double> needs, int reach) {
  // Three means of a third of the width each make a smooth one of no more than the width.
  const int part = std::max(1, reach / 3);
  std::vector<double> curve = max_within(needs, 3 * part);
  for (int i = 0; i < 3; ++i) curve = running_mean(curve, part);
  return curve;
}

}  // namespace krok::plant
