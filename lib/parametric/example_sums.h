#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "parametric/packed_examples.h"

namespace krok::parametric {

// Weighted sums of all examples of a library, made once, from which many of its blends are made:
// smoothed weights hardly leave a space of few dimensions, so that a frame of a blend of 500
// examples takes a dozen sums in place of 500 poses.
//
// Rows of weights are written in an orthonormal basis. Its first row has equal weights, so that
// what a blend leaves out sums to 0 and is bounded by the examples' spread about their mean
// (Cauchy-Schwarz). Sums are stored at twice the examples' rate in generic time, and interpolated
// linearly, as examples are between their frames; where these have a corner, at strikes, that
// differs by up to a quarter of a degree.
class ExampleSums {
 public:
  // The most that a blend of one of `rows` leaves out: of a joint's position in its parent, metres,
  // and of its rotation, radians.
  static constexpr double kMaxLeftOut = 1e-4;

  // A basis for these rows of weights, each [examples], and for all others in their span. None if
  // it is not worth it: fewer examples than kMinExamples, or a basis of more than a quarter of
  // them. Deterministic; the same for any number of threads. `packed` must be valid.
  static constexpr int kMinExamples = 48;
  static std::optional<ExampleSums> create(const PackedExamples& packed,
                                           std::span<const std::span<const double>> rows);

  int count() const { return static_cast<int>(basis_.cols()); }

  // The coefficients of a row of weights, [count()]. `left_out`: see kMaxLeftOut, of this row.
  std::vector<float> coefficients(std::span<const double> weights, double& left_out) const;

  // The sum with these coefficients at a generic time, clamped to the keytimes: positions, and
  // rotations in the hemispheres of the examples' mean, not normalised; `sum` has pose_blocks() of
  // the joints. Does not allocate.
  void add(double generic, std::span<const float> coefficients, std::span<PoseBlock> sum) const;

 private:
  ExampleSums() = default;

  Eigen::MatrixXd basis_;  // [examples x count], orthonormal columns
  double spread_ = 0;      // root of the summed squares of deviations, see kMaxLeftOut
  double rate_ = 0;        // poses per second of generic time
  int frames_ = 0;
  std::size_t blocks_ = 0;       // of a pose
  std::vector<PoseBlock> sums_;  // [frames x count x blocks]
};

}  // namespace krok::parametric
