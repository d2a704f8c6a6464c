#include "tools/krok-fit/choose_smoothing.h"

#include <algorithm>

namespace krok::cli::fit {

namespace {

// From almost none to almost affine.
constexpr double kSeries[] = {1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1, 3, 10};

}  // namespace

bool contradict_each_other(const parametric::LeftOutMeans& exact) {
  return exact.examples >= kMinInside && exact.weighted > exact.linear;
}

Result<SmoothingChoice> choose_smoothing(LibraryInput& input, const Options& options,
                                         ToolContext& context) {
  SmoothingChoice choice;
  if (options.smooth) {
    choice.smoothing = *options.smooth;
    if (choice.smoothing > 0) take_all_steps(input);
    return choice;
  }
  if (input.all_steps.empty() || input.all_steps.size() > kMaxLeftOut) return choice;
  // A library that cannot be fitted is reported by fit_library().
  const auto exact = parametric::leave_one_out(input.library, options.kernel, 0, context.jobs);
  if (!exact) return choice;
  choice.exact = parametric::means_of(*exact);
  if (!contradict_each_other(*choice.exact)) return choice;
  LibraryInput all = input;
  take_all_steps(all);
  auto tried = parametric::try_smoothings(all.library, options.kernel, kSeries, context.jobs);
  if (!tried) return choice;
  choice.tried = *std::move(tried);
  const auto best =
      std::ranges::min_element(choice.tried, {}, &parametric::SmoothingTrial::weighted);
  if (best->examples < kMinInside || best->weighted > kGain * choice.exact->weighted) {
    return choice;
  }
  choice.smoothing = best->smoothing;
  input = std::move(all);
  return choice;
}

}  // namespace krok::cli::fit
