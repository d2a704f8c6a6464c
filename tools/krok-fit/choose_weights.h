#pragma once

#include "parametric/leave_one_out.h"
#include "parametric/try_weights.h"
#include "tools/krok-fit/library_input.h"
#include "tools/krok-fit/options.h"

// Chooses the kernel of a library's weights, and whether they interpolate its examples or smooth
// the noise in them.

namespace krok::cli::fit {

struct WeightsChoice {
  rbf::Kernel kernel = rbf::Kernel::cubic;
  double smoothing = 0;
  bool is_chosen = false;           // by the trials
  parametric::WeightTrials trials;  // what was compared; no examples: nothing
};

// Min examples left out that the others can predict, and min captures they are from, for a choice.
inline constexpr int kMinInside = 5;
inline constexpr int kMinCaptures = 3;
// The cubic kernel without smoothing is used unless the best is better by this factor.
inline constexpr double kGain = 1.03;

bool contradict_each_other(const parametric::LeftOutMeans& exact);

// Follows the options, and chooses what they leave open by try_weights(): all kernels without
// smoothing, and the two that allow it with a series of smoothings up to an affine fit, by
// trial_to_use(). Too few captures: cubic, which reproduces the examples. Smoothed weights use
// nearly all examples, since each one left out makes the mean less certain. Those that interpolate
// use examples that are apart: detected steps always, other motions if that predicts them clearly
// better.
WeightsChoice choose_weights(LibraryInput& input, const Options& options, ToolContext& context);

}  // namespace krok::cli::fit
