#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rbf/weight_function.h"

// Sobol sequence: a low-discrepancy sequence of points in the unit cube (Sobol 1967; direction
// numbers from Joe and Kuo, Constructing Sobol sequences with better two-dimensional projections,
// 2008, file new-joe-kuo-6.21201; Gray code order of Antonov and Saleev).

namespace krok::rbf {

class Sobol {
 public:
  // 1 to kMaxDimensions dimensions. Seed 0 is the plain sequence, whose first point is 0; any other
  // seed applies a random digital shift (XOR), which keeps the uniformity.
  explicit Sobol(int dimensions, std::uint64_t seed = 0);

  // Point `index`, [dimensions], each in [0, 1).
  void point(std::uint32_t index, std::span<double> point) const;

 private:
  std::size_t dimensions_;
  std::array<std::array<std::uint32_t, 32>, kMaxDimensions> directions_ = {};
  std::array<std::uint32_t, kMaxDimensions> shift_ = {};
};

// The first `count` points of the sequence, scaled to the function's range, for which `inside` is
// true; [count x d] in parameter units. Fewer if less than a thousandth of the points are inside.
std::vector<double> points_inside(const WeightFunction& function, int count, std::uint64_t seed,
                                  const Inside& inside);

}  // namespace krok::rbf
