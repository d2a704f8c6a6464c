#pragma once

#include <optional>
#include <vector>

#include "parametric/leave_one_out.h"
#include "tools/krok-fit/library_input.h"
#include "tools/krok-fit/options.h"

// Chooses whether the weights of a library interpolate its examples or smooth the noise in them.

namespace krok::cli::fit {

struct SmoothingChoice {
  double smoothing = 0;  // of the weight function
  // Leave-one-out errors without and with smoothing; both empty if none was tried.
  std::optional<parametric::LeftOutMeans> exact;
  std::vector<parametric::SmoothingTrial> tried;
};

// Follows the options. With --smooth auto, smoothing is tried for detected steps with at least
// kMinInside of them inside the range of the others, if an affine fit predicts examples better than
// interpolating weights, which means that steps contradict each other. The best of a series is used
// if it reduces the error to at most kGain of its value. With smoothing the library uses all
// detected steps.
inline constexpr int kMinInside = 5;
inline constexpr double kGain = 0.8;
bool contradict_each_other(const parametric::LeftOutMeans& exact);
Result<SmoothingChoice> choose_smoothing(LibraryInput& input, const Options& options,
                                         ToolContext& context);

}  // namespace krok::cli::fit
