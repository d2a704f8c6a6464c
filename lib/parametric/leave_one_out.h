#pragma once

#include <optional>
#include <span>
#include <vector>

#include "parametric/bounds.h"
#include "parametric/library.h"
#include "parametric/packed_examples.h"
#include "rbf/weight_solver.h"

namespace krok::parametric {

// Leave-one-out error of an example: RMS distance over all joints and the whole motion (metres) to
// what the library without it makes, both relative to their stance foot and compared at the same
// fraction between keytimes.
struct HeldOut {
  int example = 0;
  double weighted = 0;  // by the weight function of the others
  double linear = 0;    // by its affine part alone: the least-squares fit to the others' weights
  double nearest = 0;   // by the other example with the nearest parameters, scaled by their ranges
  bool inside = false;  // whether its parameters are within the bounds of the others
  bool failed = false;  // whether the others give no motion there; the distances are then 0
};

// Leaves out each example in turn. `kernel` and `smoothing` are those of the weight functions,
// which are not refined. Independent of the number of jobs (threads, see thread_count()). Codes:
// those of check(Library) and of WeightSolver::create() for all examples together.
Result<std::vector<HeldOut>> leave_one_out(const Library& library, rbf::Kernel kernel,
                                           double smoothing = 0, int jobs = 1);

// Means over the examples inside the bounds of the others, since only those can be predicted; 0 if
// there are none.
struct LeftOutMeans {
  int examples = 0;
  double weighted = 0, linear = 0, nearest = 0;  // metres
};
LeftOutMeans means_of(std::span<const HeldOut> left_out);

// The same distance between each example and the motion that a weight function gives at its
// parameters, [examples]: 0 up to rounding if the weights interpolate, larger with smoothing.
// Infinity if there is no such motion. Codes: those of check(Library) and
// WeightEvaluator::create(); parametric-weights if the function is for another library.
Result<std::vector<double>> distances_to_examples(const Library& library,
                                                  const rbf::WeightFunction& function);

}  // namespace krok::parametric

// What leaving examples out and trying weights share: simple weights to compare with, and the
// distance between a blend and an example.

namespace krok::parametric::detail {

// The parameters of all examples, [examples x d].
std::vector<double> parameters_of(const Library& library);

// The unrefined weight function of the examples. Codes: those of WeightSolver::create().
Result<rbf::WeightFunction> weights_of(const Library& library, rbf::Kernel kernel,
                                       double smoothing);

// Values of the least-squares affine fit of the examples' weights at a point, [examples].
std::vector<double> plane_weights(const Bounds& bounds, std::span<const double> point);

// 1 for the example with the nearest parameters, scaled by their ranges.
std::vector<double> nearest_weights(const Bounds& bounds, std::span<const double> point);

// Positions of an example's joints at fixed fractions of its intervals, [samples x joints], without
// the joints above the hips.
std::vector<Vec3> example_poses(const Library& library, std::size_t index);
// The number of those samples.
std::size_t samples_of(const Library& library);

// RMS distance over joints and samples between the blend with these weights and such positions,
// metres; nullopt if there is no such blend.
std::optional<double> distance(const Library& library, const PackedExamples& packed,
                               std::span<const double> weights, const std::vector<Vec3>& wanted);

}  // namespace krok::parametric::detail
