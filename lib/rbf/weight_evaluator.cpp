#include "rbf/weight_evaluator.h"

#include <algorithm>

#include "rbf/evaluate_internal.h"

namespace krok::rbf {

namespace {

constexpr std::size_t kLanes = detail::kLanes;

std::size_t blocks_for(std::size_t count) {
  return (count + kLanes - 1) / kLanes;
}

}  // namespace

Result<WeightEvaluator> WeightEvaluator::create(const WeightFunction& function) {
  if (Status status = function.check(); !status) return status.error();
  WeightEvaluator e;
  e.kernel_ = function.kernel;
  e.dimensions_ = static_cast<std::size_t>(function.dimensions);
  e.examples_ = static_cast<std::size_t>(function.examples);
  const std::size_t d = e.dimensions_, n = e.examples_;
  const auto centres = static_cast<std::size_t>(function.centre_count());
  e.centre_blocks_ = blocks_for(centres);
  e.lower_ = function.lower;
  for (std::size_t i = 0; i < d; ++i) {
    e.inverse_range_.push_back(1 / (function.upper[i] - function.lower[i]));
  }
  // Padding: centres at 0 with radius 1.
  e.centres_.resize(d * e.centre_blocks_);
  e.inverse_squares_.resize(e.centre_blocks_);
  for (Block& block : e.inverse_squares_) std::ranges::fill(block.values, 1.0);
  double scaled[kMaxDimensions];
  for (std::size_t k = 0; k < centres; ++k) {
    function.scale(function.centre(static_cast<int>(k)), scaled);
    for (std::size_t i = 0; i < d; ++i) {
      e.centres_[i * e.centre_blocks_ + k / kLanes].values[k % kLanes] = scaled[i];
    }
    if (has_radii(e.kernel_)) {
      e.inverse_squares_[k / kLanes].values[k % kLanes] =
          1 / (function.radii[k] * function.radii[k]);
    }
  }
  e.coefficients_.resize(blocks_for(n) * e.centre_blocks_ * kLanes);
  e.affine_.resize((d + 1) * blocks_for(n));
  for (std::size_t j = 0; j < n; ++j) {
    const std::size_t block = j / kLanes * kLanes;
    const std::size_t width = n - block > 4 ? kLanes : 4;
    const std::size_t begin = block * e.centre_blocks_ * kLanes;
    for (std::size_t k = 0; k < centres; ++k) {
      const std::size_t place = begin + k * width + (j - block);
      e.coefficients_[place / kLanes].values[place % kLanes] = function.coefficients[k * n + j];
    }
    for (std::size_t i = 0; i <= d; ++i) {
      e.affine_[i * blocks_for(n) + j / kLanes].values[j % kLanes] = function.affine[i * n + j];
    }
  }
  return e;
}

void WeightEvaluator::run(const double* point, double* weights, double* slopes) const {
  double scaled[kMaxDimensions];
  for (std::size_t i = 0; i < dimensions_; ++i) {
    scaled[i] = (point[i] - lower_[i]) * inverse_range_[i];
  }
  const detail::Job job{kernel_,
                        dimensions_,
                        examples_,
                        centre_blocks_ * kLanes,
                        centres_.data()->values,
                        inverse_squares_.data()->values,
                        coefficients_.data()->values,
                        affine_.data()->values};
  detail::evaluate_best(job, scaled, weights, slopes);
  // Removes the rounding error of the sum, which is large if the coefficients are.
  double sums[2] = {};
  for (std::size_t j = 0; j < examples_; ++j) sums[j % 2] += weights[j];
  const double more = (1 - (sums[0] + sums[1])) / static_cast<double>(examples_);
  for (std::size_t j = 0; j < examples_; ++j) weights[j] += more;
}

void WeightEvaluator::weights(std::span<const double> point, std::span<double> weights) const {
  run(point.data(), weights.data(), nullptr);
}

void WeightEvaluator::slopes(std::span<const double> point, std::span<double> weights,
                             std::span<double> slopes) const {
  run(point.data(), weights.data(), slopes.data());
  for (std::size_t i = 0; i < dimensions_; ++i) {
    for (std::size_t j = 0; j < examples_; ++j) slopes[i * examples_ + j] *= inverse_range_[i];
  }
}

}  // namespace krok::rbf
