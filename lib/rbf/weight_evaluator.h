#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "rbf/weight_function.h"

// Weights for parameters, fast: a weight function packed for vector instructions (AVX-512 or AVX2
// where the machine has them; the same bits with each and without).

namespace krok::rbf {

class WeightEvaluator {
 public:
  // Codes: those of WeightFunction::check().
  static Result<WeightEvaluator> create(const WeightFunction& function);

  int dimensions() const { return static_cast<int>(dimensions_); }
  int examples() const { return static_cast<int>(examples_); }

  // Of the parameters' range, [d].
  std::span<const double> lower() const { return lower_; }
  std::span<const double> inverse_ranges() const { return inverse_range_; }

  // The weights, [examples], at a point, [d] in the parameters' own units. Outside the range the
  // functions go on; there they are not to be trusted. A parameter that is NaN gives NaN, and one
  // beyond 1e50 ranges may. Allocates nothing; may be called from several threads. The spans do not
  // overlap.
  void weights(std::span<const double> point, std::span<double> weights) const;

  // The same for [points x d]: weights are [points x examples].
  void weights_of_many(std::span<const double> points, std::span<double> weights) const;

  // The weights and their slopes d w_i / d p_a as [d x examples], for one of a parameter's own
  // unit. With the linear kernel slopes are taken as 0 for a centre's own part at the centre.
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
  std::size_t centre_blocks_ = 0;              // of eight
  std::vector<double> lower_, inverse_range_;  // [d]
  std::vector<Block> centres_;                 // [d x centre blocks], scaled
  std::vector<Block> inverse_squares_;         // [centre blocks], 1 / radius^2
  std::vector<Block> coefficients_;            // see evaluate_internal.h
  std::vector<Block> affine_;                  // [(d + 1) x blocks of examples]
};

}  // namespace krok::rbf
