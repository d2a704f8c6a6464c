#include "formats/container/packed_orientation.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "formats/container/orientation_search_internal.h"
#include "formats/container/sections.h"

namespace krok {

using namespace orientation_search;

namespace {

// A smaller w needs more steps. Most orientations of a motion need none or a few.
std::size_t steps_worth_trying(double w) {
  const int reach = std::abs(w) > kOneRing ? 1 : std::abs(w) > kThreeRings ? 3 : kReach;
  return static_cast<std::size_t>((2 * reach + 1) * (2 * reach + 1));
}

double rebuilt_w(double x, double y, double z) {
  const double square = 1 - x * x - y * y - z * z;
  return square > 0 ? -std::sqrt(square) : 0.0;
}

// Distance from |value|, finite, to the next larger float.
double spacing(float value) {
  const float size = std::abs(value);
  const float next = std::bit_cast<float>(std::bit_cast<std::uint32_t>(size) + 1);
  return static_cast<double>(next) - static_cast<double>(size);
}

float rounded(double value) {
  return static_cast<float>(value) + 0.0f;  // no -0
}

// Indices of the largest, second and smallest component by magnitude; ties in index order.
std::array<int, 3> by_size(const Vec4& target) {
  std::array<int, 3> order = {0, 1, 2};
  const auto settle = [&](std::size_t i, std::size_t j) {
    if (std::abs(target[order[i]]) < std::abs(target[order[j]])) std::swap(order[i], order[j]);
  };
  settle(0, 1);
  settle(1, 2);
  settle(0, 1);
  return order;
}

// `target` is a unit quaternion x, y, z, w with w <= 0.
std::array<float, 3> search(const Vec4& target) {
  const std::array<int, 3> order = by_size(target);
  const double a = target[order[0]], b = target[order[1]], c = target[order[2]], w = target[3];
  const float nearest_a = rounded(a);
  const double spacing_a = spacing(nearest_a);
  const double rest_of_a = std::sqrt(b * b + c * c + w * w);
  const double rest_of_b = std::sqrt(c * c + w * w);
  // Scale of the other components that compensates for the rounding of one.
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

  // Fixing a leaves a sphere for b, c and w; fixing b leaves a circle for c and w. Takes the
  // closest points on them. The sphere depends only on the step of a.
  struct AfterA {
    float try_a, nearest_b;
    double left, spacing_b;
    bool known;
  };
  std::array<AfterA, kSide> after_a{};
  consider(nearest_a, rounded(b), rounded(c));
  for (const Step& step : std::span(kSteps).first(steps_worth_trying(w))) {
    if (best_distance <= kGoodEnough) break;
    AfterA& at = after_a[static_cast<std::size_t>(step.first + kReach)];
    if (!at.known) {
      at.try_a = rounded(double{nearest_a} + step.first * spacing_a);
      at.left = 1 - double{at.try_a} * double{at.try_a};
      at.nearest_b = rounded(b * scale(at.left, rest_of_a));
      at.spacing_b = spacing(at.nearest_b);
      at.known = true;
    }
    const float try_b = rounded(double{at.nearest_b} + step.second * at.spacing_b);
    const double left_by_b = at.left - double{try_b} * double{try_b};
    const float try_c = rounded(c * scale(left_by_b, rest_of_b));
    consider(at.try_a, try_b, try_c);
  }
  return best;
}

}  // namespace

std::array<float, 3> pack_orientation(const Quat& q) {
  Vec4 target = q.coeffs();
  if (target[3] > 0) target = -target;
  const std::array<float, 3> plain = {rounded(target[0]), rounded(target[1]), rounded(target[2])};
  const double w = rebuilt_w(double{plain[0]}, double{plain[1]}, double{plain[2]});
  // Already exact: keeps unpacked orientations unchanged.
  if (static_cast<float>(w) == static_cast<float>(target[3])) return plain;
  const double length = std::sqrt((target[0] * target[0] + target[1] * target[1]) +
                                  (target[2] * target[2] + target[3] * target[3]));
  if (!(length > 0) || !std::isfinite(length)) return {};
  target /= length;
  const std::array<float, 3> nearest = {rounded(target[0]), rounded(target[1]), rounded(target[2])};
  const Vec4 found(double{nearest[0]}, double{nearest[1]}, double{nearest[2]},
                   rebuilt_w(double{nearest[0]}, double{nearest[1]}, double{nearest[2]}));
  const Vec4 off = found - target;
  const double distance = off[0] * off[0] + off[1] * off[1] + off[2] * off[2] + off[3] * off[3];
  return distance <= kGoodEnough ? nearest : search(target);
}

Quat unpack_orientation(const std::array<float, 3>& xyz) {
  const double x{xyz[0]}, y{xyz[1]}, z{xyz[2]};
  return Quat(rebuilt_w(x, y, z), x, y, z);
}

}  // namespace krok

namespace krok::pack_transforms_detail {

void pack_scalar(const float* positions, const float* orientations, std::size_t count,
                 std::byte* out) {
  constexpr auto kEncoding = OrientationEncoding::xyz;
  for (std::size_t i = 0; i < count; ++i) {
    const float* q = orientations + 4 * i;
    const float* p = positions + 3 * i;
    write_transform({p[0], p[1], p[2]}, Quatf(q[3], q[0], q[1], q[2]).cast<double>(), kEncoding,
                    out + i * transform_size(kEncoding));
  }
}

}  // namespace krok::pack_transforms_detail
