#include "formats/container/packed_orientation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace krok {

namespace {

// Steps (in units of the last place) by which the two largest components are moved, nearest first;
// the third is solved for.
constexpr int kReach = 6;
constexpr int kSide = 2 * kReach + 1;

struct Step {
  int first = 0, second = 0;
};

constexpr std::array<Step, kSide * kSide> make_steps() {
  std::array<Step, kSide * kSide> steps{};
  std::size_t count = 0;
  for (int ring = 0; ring <= kReach; ++ring) {
    for (int i = -ring; i <= ring; ++i) {
      for (int j = -ring; j <= ring; ++j) {
        if (i == ring || i == -ring || j == ring || j == -ring) steps[count++] = {i, j};
      }
    }
  }
  return steps;
}
constexpr auto kSteps = make_steps();

// Good enough to stop searching: 2e-7 rad, a few times what rounding four components costs anyway.
// Squared distance of quaternions; the angle is twice the distance.
constexpr double kGoodEnough = 1e-7 * 1e-7;

// The smaller w, the more there is to gain, and the finer the steps that it takes. Most
// orientations of a motion need none or a few.
std::size_t steps_worth_trying(double w) {
  const int reach = std::abs(w) > 0.02 ? 1 : std::abs(w) > 0.002 ? 3 : kReach;
  return static_cast<std::size_t>((2 * reach + 1) * (2 * reach + 1));
}

double rebuilt_w(double x, double y, double z) {
  const double square = 1 - x * x - y * y - z * z;
  return square > 0 ? -std::sqrt(square) : 0.0;
}

double spacing(float value) {
  const float size = std::abs(value);
  return static_cast<double>(std::nextafter(size, 2.0f)) - static_cast<double>(size);
}

float rounded(double value) {
  return static_cast<float>(value) + 0.0f;
}  // no -0

// `target` is a unit quaternion x, y, z, w with w <= 0.
std::array<float, 3> search(const Vec4& target) {
  std::array<int, 3> order = {0, 1, 2};
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return std::abs(target[a]) > std::abs(target[b]); });
  const double a = target[order[0]], b = target[order[1]], c = target[order[2]], w = target[3];
  const float nearest_a = rounded(a);
  const double spacing_a = spacing(nearest_a);
  const double rest_of_a = std::sqrt(b * b + c * c + w * w);
  const double rest_of_b = std::sqrt(c * c + w * w);
  // By how much the other components grow to make up for what rounding took from one.
  const auto scale = [](double square_left, double rest) {
    return square_left > 0 && rest > 0 ? std::sqrt(square_left) / rest : 0.0;
  };

  std::array<float, 3> best{};
  double best_distance = std::numeric_limits<double>::infinity();
  const auto consider = [&](float try_a, float try_b, float try_c) {
    const double found_w = rebuilt_w(double{try_a}, double{try_b}, double{try_c});
    const double da = double{try_a} - a, db = double{try_b} - b, dc = double{try_c} - c;
    const double dw = found_w - w;
    const double distance = da * da + db * db + dc * dc + dw * dw;
    if (distance >= best_distance) return;
    best_distance = distance;
    best[static_cast<std::size_t>(order[0])] = try_a;
    best[static_cast<std::size_t>(order[1])] = try_b;
    best[static_cast<std::size_t>(order[2])] = try_c;
  };

  consider(nearest_a, rounded(b), rounded(c));
  for (const Step& step : std::span(kSteps).first(steps_worth_trying(w))) {
    if (best_distance <= kGoodEnough) break;
    // What is given to a leaves a sphere for b, c and w, then b a circle for c and w; the closest
    // points on them.
    const float try_a = rounded(double{nearest_a} + step.first * spacing_a);
    const double left_by_a = 1 - double{try_a} * double{try_a};
    const float nearest_b = rounded(b * scale(left_by_a, rest_of_a));
    const float try_b = rounded(double{nearest_b} + step.second * spacing(nearest_b));
    const double left_by_b = left_by_a - double{try_b} * double{try_b};
    consider(try_a, try_b, rounded(c * scale(left_by_b, rest_of_b)));
  }
  return best;
}

}  // namespace

std::array<float, 3> pack_orientation(const Quat& q) {
  Vec4 target = q.coeffs();
  if (target[3] > 0) target = -target;
  const std::array<float, 3> plain = {rounded(target[0]), rounded(target[1]), rounded(target[2])};
  const double w = rebuilt_w(double{plain[0]}, double{plain[1]}, double{plain[2]});
  // Comes back as it is: what was unpacked before stays what it was.
  if (static_cast<float>(w) == static_cast<float>(target[3])) return plain;
  const double length = target.norm();
  if (!(length > 0) || !std::isfinite(length)) return {};
  return search(target / length);
}

Quat unpack_orientation(const std::array<float, 3>& xyz) {
  const double x{xyz[0]}, y{xyz[1]}, z{xyz[2]};
  return Quat(rebuilt_w(x, y, z), x, y, z);
}

}  // namespace krok
