#pragma once

#include <span>
#include <vector>

#include "parametric/library.h"
#include "rbf/weight_function.h"

// Which weights predict captures best: cross-validation over whole captures.

namespace krok::parametric {

// A way to make weights: kernel and smoothing as in rbf::SolverOptions, from the examples left by
// thin_out() with this spacing, or with smoothing by thin_out_smoothed().
struct WeightCandidate {
  rbf::Kernel kernel = rbf::Kernel::cubic;
  double smoothing = 0;
  double spacing = 0;

  bool operator==(const WeightCandidate&) const = default;
};

struct WeightTrial {
  WeightCandidate candidate;
  double distance = 0;  // mean over the examples left out, metres
  int failed = 0;       // examples for which it gives no motion, which `distance` leaves out
  // Standard error, metres, of how much `distance` exceeds that of the best trial, from the spread
  // of the differences between captures; 0 for the best, and for those that failed.
  double uncertain = 0;
};

// Means over the same examples, so that they can be compared.
struct WeightTrials {
  std::vector<WeightTrial> tried;  // as the candidates
  std::size_t best = 0;            // the one with the least distance among those that never failed
  int examples = 0, groups = 0;    // left out and inside the bounds of the others, and of how many
                                   // captures these are
  double planes = 0;               // by the affine fit to the others' weights, metres
  double nearest = 0;              // by the example with the nearest parameters, metres
};

// Leaves out whole captures, a tenth of them at a time (each alone if there are fewer than ten),
// since steps of one capture resemble each other more than those of another, and compares what the
// others make with each example left out: the distances are those of HeldOut. Only examples inside
// the bounds of the others are predicted, at most 20 of each part. `groups`: [examples], the
// capture that an example is from, from 0. Independent of the number of jobs. Codes: those of
// check(Library); parametric-groups if their number is not that of the examples.
Result<WeightTrials> try_weights(const Library& library, std::span<const int> groups,
                                 std::span<const WeightCandidate> candidates, int jobs = 1);

// Index of the trial to use, of at least one:
//
// - the first, unless the best is better by more than the factor `gain`;
// - the best, if it has no smoothing;
// - otherwise that with the most smoothing of those that are at most one standard error worse than
//   the best, the first of equals (Breiman and others: Classification and Regression Trees, 1984,
//   ch. 3.4.3). A dozen captures cannot tell neighbouring smoothings apart, and too little predicts
//   new captures worse than too much: of walks of one man, the best of 20 trials was 5 % worse than
//   planes.
std::size_t trial_to_use(const WeightTrials& trials, double gain);

}  // namespace krok::parametric
