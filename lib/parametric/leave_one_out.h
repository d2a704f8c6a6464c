#pragma once

#include <span>
#include <vector>

#include "parametric/library.h"
#include "rbf/weight_solver.h"

namespace krok::parametric {

// How near a library without one of its examples comes to that example: the distance of all joints
// over the motion, root mean square (metres), each motion seen from its own stance foot and
// compared at the same part between the same keytimes.
struct HeldOut {
  int example = 0;
  double weighted = 0;  // by the weight function of the others
  double linear = 0;    // by its plane alone: the least-squares fit to the others' weights
  double nearest = 0;  // by the other example whose parameters, scaled by their ranges, are nearest
  bool inside = false;  // whether its parameters lie between the others'
  bool failed = false;  // whether the others make no motion there; the distances are then 0
};

// Each example left out in turn. `kernel` and `smoothing` are those of the weight functions;
// nothing is refined. The same with any number of jobs (threads, see thread_count()). Codes: those
// of check(Library) and of WeightSolver::create() for all examples together.
Result<std::vector<HeldOut>> leave_one_out(const Library& library, rbf::Kernel kernel,
                                           double smoothing = 0, int jobs = 1);

// Means over the examples that lie between the others, for there alone the others can tell; 0 where
// there are none.
struct LeftOutMeans {
  int examples = 0;
  double weighted = 0, linear = 0, nearest = 0;  // metres
};
LeftOutMeans means_of(std::span<const HeldOut> left_out);

// The same distance from each example to what a weight function makes at the example's own
// parameters, [examples]: 0 but for rounding where weights meet the examples, more with smoothing.
// Infinite where there is no such motion. Codes: those of check(Library) and of
// WeightEvaluator::create(); parametric-weights where the function is for another library.
Result<std::vector<double>> distances_to_examples(const Library& library,
                                                  const rbf::WeightFunction& function);

// How far off the weights of others are with a smoothing, in the mean over the examples that lie
// between the others and that the others can make.
struct SmoothingTrial {
  double smoothing = 0;
  int examples = 0;
  double weighted = 0;  // metres
};
// One for each of the smoothings. Codes as those of leave_one_out().
Result<std::vector<SmoothingTrial>> try_smoothings(const Library& library, rbf::Kernel kernel,
                                                   std::span<const double> smoothings,
                                                   int jobs = 1);

}  // namespace krok::parametric
