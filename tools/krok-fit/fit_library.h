#pragma once

#include <vector>

#include "core/result.h"
#include "fit/refine.h"
#include "parametric/leave_one_out.h"
#include "parametric/measure.h"
#include "tools/krok-fit/choose_weights.h"
#include "tools/krok-fit/library_input.h"
#include "tools/krok-fit/options.h"

namespace krok::cli::fit {

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

// Measures blends of the library; thread-safe. `measure` must outlive it.
rbf::Measure measure_of(const parametric::Measure& measure);

// Weights for the examples alone or from `start`, refined and polished according to the options.
// Codes: those of rbf::WeightSolver, with the names of the examples, and of krok::fit::refine.
Result<FittedLibrary> fit_library(const LibraryInput& input, const Options& options,
                                  WeightsChoice choice, const krok::fit::Refined* start,
                                  ToolContext& context);

}  // namespace krok::cli::fit
