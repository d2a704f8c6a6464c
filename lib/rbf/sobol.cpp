#include "rbf/sobol.h"

#include <algorithm>

#include <cstddef>

namespace krok::rbf {

namespace {

// From the second dimension on: degree and inner coefficients of a primitive polynomial, and the
// initial direction numbers.
struct Polynomial {
  std::uint32_t degree, inner;
  std::array<std::uint32_t, 5> first;
};
constexpr Polynomial kPolynomials[kMaxDimensions - 1] = {
    {1, 0, {1}},          {2, 1, {1, 3}},        {3, 1, {1, 3, 1}},       {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}}, {4, 4, {1, 3, 5, 13}}, {5, 2, {1, 1, 5, 5, 17}}};

// SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15u;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
  return value ^ (value >> 31);
}

}  // namespace

Sobol::Sobol(int dimensions, std::uint64_t seed)
    : dimensions_(static_cast<std::size_t>(dimensions)) {
  for (std::size_t bit = 0; bit < 32; ++bit) directions_[0][bit] = std::uint32_t{1} << (31 - bit);
  for (std::size_t i = 1; i < dimensions_; ++i) {
    const Polynomial& polynomial = kPolynomials[i - 1];
    const std::size_t degree = polynomial.degree;
    auto& v = directions_[i];
    for (std::size_t bit = 0; bit < 32; ++bit) {
      if (bit < degree) {
        v[bit] = polynomial.first[bit] << (31 - bit);
        continue;
      }
      v[bit] = v[bit - degree] ^ (v[bit - degree] >> degree);
      for (std::size_t k = 1; k < degree; ++k) {
        if ((polynomial.inner >> (degree - 1 - k) & 1u) != 0) v[bit] ^= v[bit - k];
      }
    }
  }
  if (seed == 0) return;
  for (std::size_t i = 0; i < dimensions_; ++i) {
    shift_[i] = static_cast<std::uint32_t>(mixed(seed * kMaxDimensions + i) >> 32);
  }
}

void Sobol::point(std::uint32_t index, std::span<double> point) const {
  const std::uint32_t gray = index ^ (index >> 1);
  for (std::size_t i = 0; i < dimensions_; ++i) {
    std::uint32_t digits = shift_[i];
    for (std::size_t bit = 0; bit < 32; ++bit) {
      if ((gray >> bit & 1u) != 0) digits ^= directions_[i][bit];
    }
    point[i] = digits * 0x1p-32;
  }
}

std::vector<double> points_inside(const WeightFunction& function, int count, std::uint64_t seed,
                                  const Inside& inside) {
  constexpr std::uint32_t kMaxTried = 1000;  // per wanted point
  const auto d = static_cast<std::size_t>(function.dimensions);
  const Sobol sobol(function.dimensions, seed);
  const auto wanted = static_cast<std::uint32_t>(std::max(count, 0));
  std::vector<double> points, point(d);
  for (std::uint32_t p = 0; points.size() < wanted * d && p / kMaxTried < wanted; ++p) {
    sobol.point(p, point);
    for (std::size_t i = 0; i < d; ++i) {
      point[i] = function.lower[i] + point[i] * (function.upper[i] - function.lower[i]);
    }
    if (!inside || inside(point)) points.insert(points.end(), point.begin(), point.end());
  }
  return points;
}

}  // namespace krok::rbf
