#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "rbf/weight_function.h"

// Fast evaluation of a weight function, packed for SIMD (AVX-512 or AVX2 if the machine has them).
// Results are bit-identical on all instruction sets.

namespace krok::rbf {

class WeightEvaluator {
 public:
  // Codes: those of WeightFunction::check().
  static Result<WeightEvaluator> create(const WeightFunction& function);

  int dimensions() const { return static_cast<int>(dimensions_); }
  int examples() const { return static_cast<int>(examples_); }

  // The parameters' range, [d].
  std::span<const double> lower() const { return lower_; }
  std::span<const double> inverse_ranges() const { return inverse_range_; }

  // Weights, [examples], at a point, [d] in parameter units. Outside the range the function
  // extrapolates and is not reliable. NaN parameters give NaN; parameters beyond 1e50 ranges may.
  // Does not allocate; thread-safe. The spans must not overlap.
  void weights(std::span<const double> point, std::span<double> weights) const;

  // Weights and their derivatives d w_i / d p_a, [d x examples], per parameter unit. For the linear
  // kernel, the derivative of a centre's own term at the centre is 0.
  void slopes(std::span<const double> point, std::span<double> weights,
              std::span<double> slopes) const;

 private:
  struct alignas(64) Block {
    double values[8];
  };
  WeightEvaluator() = default;
  void run(const double* point, double* weights, double* slopes) const;

  Kernel kernel_ = Kernel::cubic;
  std::size_t dimensions_ = 0, examples_ = 0;
  std::size_t centre_blocks_ = 0;              // of eight centres
  std::vector<double> lower_, inverse_range_;  // [d]
  std::vector<Block> centres_;                 // [d x centre blocks], scaled
  std::vector<Block> inverse_squares_;         // [centre blocks], 1 / radius^2
  std::vector<Block> coefficients_;            // see evaluate_internal.h
  std::vector<Block> affine_;                  // [(d + 1) x blocks of examples]
};

}  // namespace krok::rbf
