#pragma once

#include <vector>

#include "core/result.h"
#include "fit/refine.h"
#include "parametric/leave_one_out.h"
#include "parametric/measure.h"
#include "parametric/try_weights.h"
#include "tools/krok-fit/library_input.h"
#include "tools/krok-fit/options.h"

namespace krok::cli::fit {

struct WeightsChoice {
  rbf::Kernel kernel = rbf::Kernel::cubic;
  double smoothing = 0;
  bool is_chosen = false;           // by the trials
  parametric::WeightTrials trials;  // what was compared; no examples: nothing
};

bool contradict_each_other(const parametric::LeftOutMeans& exact);

// Chooses the kernel of a library's weights, and whether they interpolate its examples or smooth
// the noise in them. Follows the options, and chooses what they leave open by try_weights(): all
// kernels without smoothing, and the two that allow it with a series of smoothings up to an affine
// fit, by trial_to_use(). Too few captures: cubic, which reproduces the examples. Smoothed weights
// use nearly all examples, since each one left out makes the mean less certain. Those that
// interpolate use examples that are apart: detected steps always, other motions if that predicts
// them clearly better.
WeightsChoice choose_weights(LibraryInput& input, const Options& options, ToolContext& context);

// The weight functions of a library, and their inputs.
struct FittedLibrary {
  parametric::PackedExamples packed;
  std::vector<double> tolerances;  // [parameters], in parameter units
  krok::fit::Refined start;        // before this run's refinement
  krok::fit::Refined refined;
  double seconds = 0;  // time of refinement; not written to any file
  WeightsChoice choice;
  double exact_spacing = 0;  // see LibraryInput
  // Leave-one-out errors with unrefined weights; empty for more than kMaxLeftOut examples.
  std::vector<parametric::HeldOut> left_out;
  double example_distance =
      0;  // with smoothing: mean distance between examples and their reproduction
};

// Weights for the examples alone or from `start`, refined and polished according to the options.
// Codes: those of rbf::WeightSolver, with the names of the examples, and of krok::fit::refine.
Result<FittedLibrary> fit_library(const LibraryInput& input, const Options& options,
                                  WeightsChoice choice, const krok::fit::Refined* start,
                                  ToolContext& context);

}  // namespace krok::cli::fit
