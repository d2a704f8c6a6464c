#include "tools/krok-fit/choose_weights.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace krok::cli::fit {

namespace {

using parametric::WeightCandidate;
using rbf::Kernel;

// From almost none to affine.
constexpr double kSeries[] = {1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 100};
constexpr Kernel kKernels[] = {Kernel::cubic, Kernel::linear, Kernel::gaussian, Kernel::bspline,
                               Kernel::wendland};

// The capture of an example: detected steps have a number and a foot after its name.
std::string_view capture_of(std::string_view name) {
  std::string_view rest = name;
  if (rest.ends_with(" left") || rest.ends_with(" right")) {
    rest.remove_suffix(rest.size() - rest.rfind(' '));
    const std::size_t space = rest.rfind(' ');
    if (space == std::string_view::npos) return name;
    int number = 0;
    const auto parsed = std::from_chars(rest.data() + space + 1, rest.data() + rest.size(), number);
    if (parsed.ec == std::errc() && parsed.ptr == rest.data() + rest.size()) {
      return rest.substr(0, space);
    }
  }
  return name;
}

std::vector<int> groups_of(const parametric::Library& library) {
  std::map<std::string_view, int> numbers;
  std::vector<int> groups;
  for (const parametric::Example& example : library.examples) {
    const auto added =
        numbers.emplace(capture_of(example.name), static_cast<int>(numbers.size())).first;
    groups.push_back(added->second);
  }
  return groups;
}

// The first is used in case of doubt.
std::vector<WeightCandidate> candidates_for(const LibraryInput& input, const Options& options) {
  std::vector<WeightCandidate> list;
  const auto may_use = [&](Kernel kernel) { return !options.kernel || *options.kernel == kernel; };
  const bool thins =
      !options.smooth && input.exact_spacing < kUsualSpacing && !input.all_examples.empty();
  for (const Kernel kernel : kKernels) {
    if (!may_use(kernel) || (options.smooth && *options.smooth > 0)) continue;
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
  choice.smoothing = options.smooth.value_or(0);
  const auto candidates = candidates_for(input, options);
  parametric::Library all = input.library;
  if (!input.all_examples.empty()) all.examples = input.all_examples;
  // A library that cannot be fitted is reported by fit_library().
  if (auto trials = parametric::try_weights(all, groups_of(all), candidates, context.jobs)) {
    choice.trials = *std::move(trials);
  }
  double spacing = input.exact_spacing;
  if (choice.trials.examples >= kMinInside && choice.trials.groups >= kMinCaptures) {
    choice.is_chosen = true;
    const std::size_t used = parametric::trial_to_use(choice.trials, kGain);
    const WeightCandidate& candidate = choice.trials.tried[used].candidate;
    choice.kernel = candidate.kernel;
    choice.smoothing = candidate.smoothing;
    spacing = candidate.spacing;
  }
  if (choice.smoothing > 0) {
    take_examples(input, kSmoothedSpacing, parametric::kMaxSmoothed);
  } else if (spacing > input.exact_spacing) {
    take_examples(input, spacing, rbf::kMaxExamples);
  }
  return choice;
}

}  // namespace krok::cli::fit
