#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rbf/weight_function.h"

// Sobol's sequence: points that fill a unit cube evenly, any number of them (Sobol 1967; direction
// numbers of Joe and Kuo, Constructing Sobol sequences with better two-dimensional projections,
// 2008, their file new-joe-kuo-6.21201; in the order of Antonov and Saleev).

namespace krok::rbf {

class Sobol {
 public:
  // 1 to kMostDimensions dimensions. Seed 0 is the sequence itself, whose first point is 0; any
  // other shifts its binary digits at random, which keeps it as even (a digital shift).
  explicit Sobol(int dimensions, std::uint64_t seed = 0);

  // Point `index`, [dimensions], each in [0, 1).
  void point(std::uint32_t index, std::span<double> point) const;

 private:
  std::size_t dimensions_;
  std::array<std::array<std::uint32_t, 32>, kMaxDimensions> directions_ = {};
  std::array<std::uint32_t, kMaxDimensions> shift_ = {};
};

// The first `count` points of the sequence over a function's range that are inside, [count x d] in
// the parameters' own units; fewer where under a thousandth of them are.
std::vector<double> points_inside(const WeightFunction& function, int count, std::uint64_t seed,
                                  const Inside& inside);

}  // namespace krok::rbf
