#include "tools/krok-fit/fit_library.h"

#include <algorithm>
#include <vector>

namespace krok::cli::fit {

namespace {

using parametric::WeightCandidate;
using rbf::Kernel;

// From almost none to affine.
constexpr double kSeries[] = {1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 100};
// Min examples left out that the others can predict, and min captures they are from, for a choice.
constexpr int kMinInside = 5;
constexpr int kMinCaptures = 3;
// The cubic kernel without smoothing is used unless the best is better by this factor.
constexpr double kGain = 1.03;
constexpr double kOfSeveralStyles = 1;  // smoothing, where captures are too few to choose one
constexpr Kernel kKernels[] = {Kernel::cubic, Kernel::linear, Kernel::gaussian, Kernel::bspline,
                               Kernel::wendland};

bool has_several_styles(const parametric::Library& library) {
  return std::ranges::any_of(library.examples, [&](const parametric::Example& example) {
    return example.style != library.examples.front().style;
  });
}

// The first is used in case of doubt.
std::vector<WeightCandidate> candidates_for(const LibraryInput& input, const Options& options) {
  std::vector<WeightCandidate> list;
  // Several styles contradict each other.
  const bool contradicts = !options.smooth && has_several_styles(input.library);
  const auto may_use = [&](Kernel kernel) { return !options.kernel || *options.kernel == kernel; };
  const bool thins =
      !options.smooth && input.exact_spacing < kUsualSpacing && !input.all_examples.empty();
  for (const Kernel kernel : kKernels) {
    if (!may_use(kernel) || contradicts || (options.smooth && *options.smooth > 0)) continue;
    list.push_back({kernel, 0, input.exact_spacing});
    if (thins) list.push_back({kernel, 0, kUsualSpacing});
  }
  for (const Kernel kernel : kKernels) {
    if (!may_use(kernel)) continue;
    if (options.smooth) {
      if (*options.smooth > 0) list.push_back({kernel, *options.smooth, kSmoothedSpacing});
      continue;
    }
    if (!options.kernel && rbf::has_radii(kernel)) continue;
    for (const double smoothing : kSeries) {
      list.push_back({kernel, smoothing, kSmoothedSpacing});
    }
  }
  return list;
}

}  // namespace

bool contradict_each_other(const parametric::LeftOutMeans& exact) {
  return exact.examples >= kMinInside && exact.weighted > exact.linear;
}

WeightsChoice choose_weights(LibraryInput& input, const Options& options, ToolContext& context) {
  WeightsChoice choice;
  choice.kernel = options.kernel.value_or(Kernel::cubic);
  choice.smoothing =
      options.smooth.value_or(has_several_styles(input.library) ? kOfSeveralStyles : 0);
  const auto candidates = candidates_for(input, options);
  parametric::Library all = input.library;
  if (!input.all_examples.empty()) all.examples = input.all_examples;
  // A library that cannot be fitted is reported by fit_library().
  if (auto trials =
          parametric::try_weights(all, parametric::captures_of(all), candidates, context.jobs)) {
    choice.trials = *std::move(trials);
  }
  double spacing = input.exact_spacing;
  if (choice.trials.examples >= kMinInside && choice.trials.groups >= kMinCaptures) {
    choice.is_chosen = true;
    // The first is only preferred if it reproduces the examples.
    const bool reproduces = candidates.front().smoothing == 0 || options.smooth;
    const std::size_t used = parametric::trial_to_use(choice.trials, reproduces ? kGain : 0);
    const WeightCandidate& candidate = choice.trials.tried[used].candidate;
    choice.kernel = candidate.kernel;
    choice.smoothing = candidate.smoothing;
    spacing = candidate.spacing;
  }
  if (choice.smoothing > 0) {
    take_smoothed_examples(input);
  } else if (spacing > input.exact_spacing) {
    take_examples(input, spacing);
  }
  return choice;
}

}  // namespace krok::cli::fit
