#pragma once

#include <vector>

#include "core/result.h"
#include "fit/refine.h"
#include "parametric/leave_one_out.h"
#include "parametric/measure.h"
#include "tools/krok-fit/choose_smoothing.h"
#include "tools/krok-fit/library_input.h"
#include "tools/krok-fit/options.h"

namespace krok::fit_tool {

// The weight functions of a library, and what they were made from.
struct FittedLibrary {
  parametric::PackedExamples packed;
  std::vector<double> tolerances;  // [parameters], own units
  fit::Refined start;              // without what this run inserted
  fit::Refined refined;
  double seconds = 0;  // that refinement took; no part of any file
  SmoothingChoice smoothing;
  // Each example by the others alone, by unrefined weights; empty for over kMostLeftOut examples.
  std::vector<parametric::HeldOut> left_out;
  double example_distance = 0;  // with smoothing: how far off examples come back, in the mean
};

// Measures blends of the library; both arguments must outlive it. May be called by several threads.
rbf::Measure measure_of(const parametric::Measure& measure);

// Weights by the examples alone, or what `start` has, refined and polished as the options say.
// Codes: those of rbf::WeightSolver, with the names of the examples, and of fit::refine.
Result<FittedLibrary> fit_library(const LibraryInput& input, const Options& options,
                                  SmoothingChoice smoothing, const fit::Refined* start,
                                  ToolContext& context);

}  // namespace krok::fit_tool
