#include "tools/krok-fit/fit_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/numbers.h"
#include "fit/polish.h"
#include "math/transform.h"
#include "parametric/bounds.h"
#include "rbf/weight_solver.h"

namespace krok::cli::fit {

namespace {

using parametric::Library;

constexpr double kUsualGain = 20;  // if no tolerance is given

std::vector<double> parameters_of(const Library& library) {
  std::vector<double> points;
  for (const parametric::Example& example : library.examples) {
    points.insert(points.end(), example.parameters.begin(), example.parameters.end());
  }
  return points;
}

// The names of the two examples nearest to each other.
std::string nearest_pair(const LibraryInput& input) {
  const auto& examples = input.library.examples;
  double least = INFINITY;
  std::size_t first = 0, second = 0;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    for (std::size_t j = i + 1; j < examples.size(); ++j) {
      double square = 0;
      for (std::size_t d = 0; d < input.lower.size(); ++d) {
        const double apart = (examples[i].parameters[d] - examples[j].parameters[d]) /
                             (input.upper[d] - input.lower[d]);
        square += apart * apart;
      }
      if (square >= least) continue;
      least = square;
      first = i;
      second = j;
    }
  }
  return fmt::format("'{}' and '{}'", examples[first].name, examples[second].name);
}

Error explained(Error error, const LibraryInput& input) {
  if (error.code == "rbf-duplicate") {
    error.message = fmt::format("two examples have the same parameters: {}", nearest_pair(input));
    error.hint = "leave one out, or set \"spacing\"";
  } else if (error.code == "rbf-examples" || error.code == "rbf-rank") {
    error.message += fmt::format("; the library has {} examples for {} parameters",
                                 input.library.examples.size(), input.library.dimensions());
    error.hint = "add examples that vary each parameter independently, or leave a parameter out";
  }
  return error;
}

void warn_of_spread(const LibraryInput& input, const parametric::PackedExamples& packed,
                    ToolContext& context) {
  const parametric::Spread spread = parametric::widest_spread(packed);
  if (spread.angle <= kPi / 2) return;
  const Library& library = input.library;
  const auto name = [&](int example) {
    return library.examples[static_cast<std::size_t>(example)].name;
  };
  Diagnostic diagnostic;
  diagnostic.severity = Severity::warning;
  diagnostic.code = "fit-spread";
  diagnostic.joint = library.skeleton.names[static_cast<std::size_t>(spread.joint)];
  diagnostic.message = fmt::format(
      "'{}' and '{}' differ in {} by {:.0f} degrees; blending rotations over 90 degrees apart is "
      "unreliable",
      name(spread.first), name(spread.second), diagnostic.joint, spread.angle / kRadiansPerDegree);
  diagnostic.hint = "check both; one may be another motion or have a wrong keytime";
  context.diagnose(std::move(diagnostic));
}

// Whether the user gave a tolerance.
bool has_own_tolerance(const LibraryInput& input, const Options& options) {
  const auto& parameters = input.description.parameters;
  return options.until || std::ranges::any_of(parameters, [](const auto& entry) {
           return entry.tolerance.has_value();
         });
}

std::vector<double> tolerances_of(const Library& library, const Options& options) {
  std::vector<double> tolerances;
  for (const parametric::Parameter& parameter : library.parameters) {
    double tolerance = parameter.tolerance;
    if (options.until && unit_of(parameter) == "m") tolerance = *options.until;
    tolerances.push_back(tolerance);
  }
  return tolerances;
}

// Measures blends of the library; thread-safe. `measure` must outlive it.
rbf::Measure measure_of(const parametric::Measure& measure) {
  return [&measure](std::span<const double> weights, std::span<double> parameters,
                    std::span<double> jacobian) {
    // One scratch per thread and library.
    thread_local const parametric::Measure* owner = nullptr;
    thread_local parametric::Measure::Scratch scratch;
    if (owner != &measure) {
      scratch = measure.make_scratch();
      owner = &measure;
    }
    return measure(weights, parameters, jacobian, scratch);
  };
}

}  // namespace

Result<FittedLibrary> fit_library(const LibraryInput& input, const Options& options,
                                  WeightsChoice choice, const krok::fit::Refined* start,
                                  ToolContext& context) {
  const Library& library = input.library;
  FittedLibrary fitted;
  fitted.choice = std::move(choice);
  fitted.exact_spacing = input.exact_spacing;
  fitted.packed = parametric::pack_examples(library);
  fitted.tolerances = tolerances_of(library, options);
  warn_of_spread(input, fitted.packed, context);
  if (start != nullptr) {
    fitted.start = *start;
  } else {
    const auto solver = rbf::WeightSolver::create(
        library.dimensions(), parameters_of(library),
        {fitted.choice.kernel, input.lower, input.upper, fitted.choice.smoothing});
    if (!solver) return explained(solver.error(), input).in_file(options.first());
    fitted.start.function = solver->function();
  }

  const parametric::Measure measure(library, fitted.packed);
  const parametric::Bounds bounds = parametric::bounds_of(library);
  krok::fit::RefineOptions how;
  how.inside = [&bounds](std::span<const double> point) {
    return parametric::outside(bounds, point).distance <= 0;
  };
  how.tolerance = fitted.tolerances;
  how.points = options.refine.value_or(0);
  // Targets that are always met, so that no points are inserted.
  if (options.refine == 0) {
    how.tolerance.assign(how.tolerance.size(), INFINITY);
    how.lowest = -INFINITY;
  } else if (!has_own_tolerance(input, options)) {
    how.gain = kUsualGain;
  }
  how.seed = options.seed;
  how.held_out = options.held_out;
  how.jobs = context.jobs;
  const auto begin = std::chrono::steady_clock::now();
  auto refined = krok::fit::refine(fitted.start, measure_of(measure), how, *context.progress);
  if (!refined) {
    // An error in the saved weights is not an error in the description.
    const bool saved = start != nullptr && refined.error().code.starts_with("rbf-");
    return std::move(refined).error().in_file(saved ? options.resume : options.first());
  }
  fitted.refined = *std::move(refined);
  if (options.polish) {
    context.progress->begin("polishing", 1);
    auto polished = krok::fit::polish(fitted.refined, measure_of(measure), how);
    context.progress->advance(1);
    context.progress->end();
    if (!polished) return std::move(polished).error().in_file(options.first());
    fitted.refined = *std::move(polished);
  }
  fitted.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (fitted.refined.function.smoothing > 0) {
    const auto distances = parametric::distances_to_examples(library, fitted.refined.function);
    if (!distances) return distances.error();
    // Some examples may have no such motion: their distance is infinite.
    double sum = 0;
    int made = 0;
    for (const double distance : *distances) {
      if (!std::isfinite(distance)) continue;
      sum += distance;
      ++made;
    }
    fitted.example_distance = sum / std::max(1, made);
  }
  if (library.examples.size() <= kMaxLeftOut) {
    // Some libraries cannot be fitted without one of the examples, which is not an error here.
    const rbf::WeightFunction& function = fitted.refined.function;
    if (auto left_out =
            parametric::leave_one_out(library, function.kernel, function.smoothing, context.jobs)) {
      fitted.left_out = *std::move(left_out);
    }
  }
  return fitted;
}

}  // namespace krok::cli::fit
