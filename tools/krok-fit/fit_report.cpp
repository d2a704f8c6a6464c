#include "tools/krok-fit/fit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include "core/numbers.h"

namespace krok::cli::fit {

namespace {

using krok::fit::ParameterError;
using krok::fit::RefineMetrics;

Json errors_json(const std::vector<ParameterError>& errors, const LibraryInput& input) {
  Json result = Json::object();
  for (std::size_t d = 0; d < errors.size(); ++d) {
    Json entry;
    entry["largest"] = errors[d].largest;
    entry["mean"] = errors[d].mean;
    entry["most_95"] = errors[d].most;
    result[input.description.parameters[d].name] = std::move(entry);
  }
  return result;
}

Json metrics_json(const RefineMetrics& metrics, const LibraryInput& input) {
  Json result;
  result["within"] = errors_json(metrics.within, input);
  result["extrapolated"] = errors_json(metrics.outside, input);
  result["largest_of_range"] = metrics.largest;
  result["mean_square_of_range"] = metrics.mean_square;
  result["not_measured"] = metrics.failed;
  result["least_weight"] = metrics.least_weight;
  result["largest_weight"] = metrics.largest_weight;
  result["roughness"] = metrics.roughness;
  result["condition"] = metrics.condition;
  return result;
}

Json parameters_json(const LibraryInput& input, const FittedLibrary& fitted) {
  const parametric::Library& library = input.library;
  Json list = Json::array();
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    Json entry;
    entry["name"] = input.description.parameters[d].name;
    entry["measures"] = name_of(library.parameters[d], library.skeleton, library.keytimes);
    entry["unit"] = std::string(unit_of(library.parameters[d]));
    entry["from"] = input.lower[d];
    entry["to"] = input.upper[d];
    entry["tolerance"] = fitted.tolerances[d];
    list.push_back(std::move(entry));
  }
  return list;
}

Json rounds_json(const LibraryInput& input, const FittedLibrary& fitted) {
  Json list = Json::array();
  for (const krok::fit::RefineRound& round : fitted.refined.rounds) {
    Json entry;
    entry["inserted"] = round.inserted;
    entry["refused"] = round.refused;
    entry["by_other_parameters"] = round.by_point;
    entry["sought_of_range"] = round.sought;
    entry["after"] = metrics_json(round.after, input);
    list.push_back(std::move(entry));
  }
  return list;
}

Json refused_json(const FittedLibrary& fitted) {
  Json list = Json::array();
  for (const krok::fit::RefusedPoint& point : fitted.refined.refused) {
    Json entry;
    entry["round"] = point.round;
    entry["point"] = point.point;
    entry["reason"] = std::string(krok::fit::refusal_name(point.reason));
    entry["value"] = point.value;
    list.push_back(std::move(entry));
  }
  return list;
}

Json trials_json(const parametric::WeightTrials& trials) {
  Json list = Json::array();
  for (const parametric::WeightTrial& trial : trials.tried) {
    list.push_back({{"kernel", std::string(rbf::kernel_name(trial.candidate.kernel))},
                    {"smoothing", trial.candidate.smoothing},
                    {"spacing", trial.candidate.spacing},
                    {"failed", trial.failed},
                    {"error", trial.distance},
                    {"standard_error", trial.uncertain}});
  }
  Json result;
  result["examples"] = trials.examples;
  result["clips"] = trials.groups;
  result["planes"] = trials.planes;
  result["nearest"] = trials.nearest;
  result["weights"] = std::move(list);
  if (!trials.tried.empty()) result["best"] = trials.best;
  return result;
}

Json left_out_json(const std::vector<parametric::HeldOut>& left_out) {
  Json list = Json::array();
  for (const parametric::HeldOut& one : left_out) {
    if (one.failed) continue;
    list.push_back({{"example", one.example},
                    {"inside", one.inside},
                    {"weighted", one.weighted},
                    {"linear", one.linear},
                    {"nearest", one.nearest}});
  }
  const parametric::LeftOutMeans means = parametric::means_of(left_out);
  Json result;
  result["inside"] = means.examples;
  // Null if no example is inside the bounds of the others.
  const auto if_any = [&](double mean) { return means.examples > 0 ? Json(mean) : Json(); };
  result["weighted"] = if_any(means.weighted);
  result["linear"] = if_any(means.linear);
  result["nearest"] = if_any(means.nearest);
  result["examples"] = std::move(list);
  return result;
}

const RefineMetrics& last_found_metrics(const FittedLibrary& fitted) {
  return fitted.refined.rounds.empty() ? fitted.refined.before : fitted.refined.rounds.back().after;
}

const RefineMetrics& last_metrics(const FittedLibrary& fitted) {
  return fitted.refined.polished ? fitted.refined.polished->after : last_found_metrics(fitted);
}

std::string with_unit(double value, const ShownUnit& unit) {
  return fmt::format("{} {}", readable(value * unit.factor, 3), unit.name);
}

std::string range_text(const LibraryInput& input, std::size_t d) {
  const ShownUnit unit = unit_for_values(input.library.parameters[d]);
  return fmt::format("{} to {} {}", readable(input.lower[d] * unit.factor, 3),
                     readable(input.upper[d] * unit.factor, 3), unit.name);
}

std::string what_stopped(const krok::fit::Refined& refined) {
  switch (refined.stop) {
    case krok::fit::Stop::tolerance:
      return "tolerances reached";
    case krok::fit::Stop::points:
      return "requested number reached";
    case krok::fit::Stop::stalled:
      return "no further improvement";
    default:
      return std::string(krok::fit::stop_name(refined.stop));
  }
}

void say_polish(const LibraryInput& input, const FittedLibrary& fitted, ToolContext& context) {
  if (!fitted.refined.polished) return;
  std::string text;
  for (std::size_t d = 0; d < input.library.parameters.size(); ++d) {
    const ShownUnit unit = unit_for_errors(input.library.parameters[d]);
    text += fmt::format("{}{} (mean {})", d == 0 ? "" : ", ",
                        with_unit(last_found_metrics(fitted).within[d].largest, unit),
                        with_unit(last_found_metrics(fitted).within[d].mean, unit));
  }
  context.log(fmt::format("  polished together; before that, errors were {}", text));
}

std::string_view reason_of(krok::fit::Refusal refusal) {
  constexpr std::array kReasons = {"needs too large or too low weights",
                                   "cannot be reached by any blend", "too close to other points",
                                   "makes the weights ill-conditioned",
                                   "raises the error elsewhere"};  // [Refusal]
  return kReasons[static_cast<std::size_t>(refusal)];
}

// Refinement that ends with errors beyond the tolerances and no way to reduce them.
void warn_of_stall(const LibraryInput& input, const FittedLibrary& fitted, ToolContext& context) {
  if (fitted.refined.stop != krok::fit::Stop::stalled) return;
  const RefineMetrics& after = last_metrics(fitted);
  std::string errors;
  for (std::size_t d = 0; d < fitted.tolerances.size(); ++d) {
    if (after.within[d].largest <= fitted.tolerances[d]) continue;
    const ShownUnit unit = unit_for_errors(input.library.parameters[d]);
    errors +=
        fmt::format("{}{} {}", errors.empty() ? "" : ", ", input.description.parameters[d].name,
                    with_unit(after.within[d].largest, unit));
  }
  if (errors.empty()) return;
  std::map<krok::fit::Refusal, int> counts;
  for (const krok::fit::RefusedPoint& point : fitted.refined.refused) ++counts[point.reason];
  std::string refused;
  for (const auto& [reason, count] : counts) {
    refused += fmt::format("{}{} ({})", refused.empty() ? "" : ", ", count, reason_of(reason));
  }
  context.warn("fit-stalled",
               fmt::format("refinement ended with errors above the tolerance: {}; {} inserted, "
                           "refused: {}",
                           errors, counted(fitted.refined.function.inserted(), "point"),
                           refused.empty() ? "none" : refused),
               "add examples between those there are, allow more smoothing, or use krok-synth "
               "--correct");
}

std::string trial_text(const parametric::WeightTrial& trial) {
  if (trial.failed > 0) return "none";
  return readable(1e3 * trial.distance, 3);
}

// What was compared to choose the weights: one line for kernels that reproduce the examples, one
// for each kernel with smoothing.
void say_trials(const FittedLibrary& fitted, ToolContext& context) {
  const parametric::WeightTrials& trials = fitted.choice.trials;
  if (trials.examples == 0) return;
  std::string exact;
  std::map<rbf::Kernel, std::string> smoothed;
  for (const parametric::WeightTrial& trial : trials.tried) {
    const auto& [kernel, smoothing, spacing] = trial.candidate;
    if (smoothing > 0) {
      smoothed[kernel] += fmt::format("{}{}: {}", smoothed[kernel].empty() ? "" : ", ",
                                      readable(smoothing), trial_text(trial));
    } else {
      exact +=
          fmt::format("{}{}{} {}", exact.empty() ? "" : ", ", rbf::kernel_name(kernel),
                      spacing > fitted.exact_spacing ? " (thinned out)" : "", trial_text(trial));
    }
  }
  context.log(
      fmt::format("  weights: {}, smoothing {}; errors of {} of {} left out in turn (mm): planes "
                  "{}, nearest {}",
                  rbf::kernel_name(fitted.choice.kernel), readable(fitted.choice.smoothing),
                  counted(trials.examples, "example"), counted(trials.groups, "clip"),
                  readable(1e3 * trials.planes, 3), readable(1e3 * trials.nearest, 3)));
  if (fitted.choice.is_chosen && fitted.choice.smoothing > 0) {
    const parametric::WeightTrial& best = trials.tried[trials.best];
    context.log(
        fmt::format("    best: {}, smoothing {}; used: the most smoothing that is at most "
                    "one standard error worse",
                    rbf::kernel_name(best.candidate.kernel), readable(best.candidate.smoothing)));
  }
  if (!exact.empty()) context.log("    examples reproduced: " + exact);
  for (const auto& [kernel, text] : smoothed) {
    context.log(fmt::format("    {} with smoothing {}", rbf::kernel_name(kernel), text));
  }
}

void say_smoothing(const LibraryInput& input, const FittedLibrary& fitted, ToolContext& context) {
  const double smoothing = fitted.refined.function.smoothing;
  if (!(smoothing > 0)) {
    if (input.all_examples.empty()) return;
    const parametric::LeftOutMeans means = parametric::means_of(fitted.left_out);
    const bool compared = std::ranges::any_of(
        fitted.choice.trials.tried,
        [](const parametric::WeightTrial& trial) { return trial.candidate.smoothing > 0; });
    if (!contradict_each_other(means) || (compared && fitted.choice.is_chosen)) return;
    return context.warn(
        "fit-contradictions",
        fmt::format("steps with similar parameters differ: leave-one-out error is {} mm with "
                    "interpolation, {} mm with an affine fit",
                    readable(1e3 * means.weighted, 3), readable(1e3 * means.linear, 3)),
        "add parameters in which they differ, or fit one kind and one person alone; --smoothing N "
        "averages them, and examples are then not reproduced exactly");
  }
  context.log(
      fmt::format("  smoothing {}: mean error of the examples' joints is {} mm; --smoothing 0 "
                  "reproduces them exactly",
                  readable(smoothing), readable(1e3 * fitted.example_distance, 3)));
}

}  // namespace

// Libraries keep angles in radians, and so does the report in their file.
Json saved_json(const LibraryInput& input, const FittedLibrary& fitted) {
  const parametric::Library& library = input.library;
  Json result;
  result["name"] = input.description.name;
  result["swing"] = library.swing == FootSide::left ? "left" : "right";
  result["keytimes"] = library.keytimes;
  result["parameters"] = parameters_json(input, fitted);
  Json examples = Json::array();
  for (const parametric::Example& example : library.examples) {
    examples.push_back({{"name", example.name},
                        {"mirrored", example.mirrored},
                        {"parameters", example.parameters}});
  }
  result["examples"] = std::move(examples);
  if (!input.styles.empty()) result["styles"] = input.styles;
  result["found"] = input.found;
  Json dropped = Json::array();
  for (const parametric::DroppedStep& step : input.dropped) {
    dropped.push_back(
        {{"clip", step.walk}, {"start", step.start}, {"end", step.end}, {"reason", step.reason}});
  }
  result["dropped"] = std::move(dropped);
  result["kernel"] = std::string(rbf::kernel_name(fitted.refined.function.kernel));
  result["smoothing"] = fitted.refined.function.smoothing;
  result["example_distance"] = fitted.example_distance;
  if (fitted.choice.trials.examples > 0) {
    result["clips_left_out"] = trials_json(fitted.choice.trials);
  }
  result["inserted"] = fitted.refined.function.inserted();
  result["example_error_of_range"] = fitted.refined.example_error;
  result["before"] = metrics_json(fitted.refined.before, input);
  result["rounds"] = rounds_json(input, fitted);
  result["refused_points"] = refused_json(fitted);
  if (fitted.refined.polished) {
    result["polished"] = {{"after", metrics_json(fitted.refined.polished->after, input)},
                          {"found_rows", fitted.refined.polished->found_rows}};
  }
  result["leave_one_out"] = left_out_json(fitted.left_out);
  result["stop"] = std::string(krok::fit::stop_name(fitted.refined.stop));
  return result;
}

Json report_json(const LibraryInput& input, const FittedLibrary& fitted) {
  Json result = saved_json(input, fitted);
  if (fitted.refined.polished) result["polished"].erase("found_rows");
  std::vector<std::string> units;
  for (Json& parameter : result["parameters"]) {
    const std::string unit = parameter["unit"];
    units.push_back(unit);
    parameter["unit"] = reported_unit(unit);
    for (const char* key : {"from", "to", "tolerance"}) {
      parameter[key] = reported(parameter[key].get<double>(), unit);
    }
  }
  for (Json& example : result["examples"]) {
    for (std::size_t d = 0; d < units.size(); ++d) {
      Json& value = example["parameters"][d];
      value = reported(value.get<double>(), units[d]);
    }
  }
  const auto convert = [&](Json& metrics) {
    for (const char* where : {"within", "extrapolated"}) {
      auto unit = units.begin();
      for (Json& errors : metrics[where]) {
        for (Json& value : errors) value = reported(value.get<double>(), *unit);
        ++unit;
      }
    }
  };
  convert(result["before"]);
  for (Json& round : result["rounds"]) convert(round["after"]);
  if (result.contains("polished")) convert(result["polished"]["after"]);
  return result;
}

void say_report(const LibraryInput& input, const FittedLibrary& fitted, ToolContext& context) {
  const parametric::Library& library = input.library;
  const auto kept = static_cast<int>(library.examples.size());
  const auto dropped = static_cast<int>(input.dropped.size());
  std::string steps = fmt::format("{} ({} mirrored)", counted(kept, "example"), input.mirrored);
  if (input.found > kept) {
    steps += fmt::format(", {} more thinned out", input.found - kept);
  }
  if (dropped > 0) {
    steps += fmt::format(", {} dropped: {}", dropped, parametric::commonest_reasons(input.dropped));
  }
  context.log(fmt::format("{}: {}", context.output, steps));
  const RefineMetrics& before = fitted.refined.before;
  const RefineMetrics& after = last_metrics(fitted);
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    const ShownUnit unit = unit_for_errors(library.parameters[d]);
    context.log(fmt::format("  {}, {}: error {} before, {} after (mean {}; held out)",
                            input.description.parameters[d].name, range_text(input, d),
                            with_unit(before.within[d].largest, unit),
                            with_unit(after.within[d].largest, unit),
                            with_unit(after.within[d].mean, unit)));
  }
  if (const parametric::LeftOutMeans means = parametric::means_of(fitted.left_out);
      means.examples > 0) {
    context.log(
        fmt::format("  {} left out in turn: mean joint error {} mm; affine fit {} mm, "
                    "nearest example {} mm",
                    counted(means.examples, "inner example"), readable(1e3 * means.weighted, 3),
                    readable(1e3 * means.linear, 3), readable(1e3 * means.nearest, 3)));
  }
  say_trials(fitted, context);
  say_smoothing(input, fitted, context);
  warn_of_stall(input, fitted, context);
  say_polish(input, fitted, context);
  context.log(fmt::format("  {} inserted in {} ({} s): {}; weights {} to {}",
                          counted(fitted.refined.function.inserted(), "point"),
                          counted(fitted.refined.rounds.size(), "round"),
                          readable(fitted.seconds, 3), what_stopped(fitted.refined),
                          readable(after.least_weight, 3), readable(after.largest_weight, 3)));
}

ShownUnit unit_for_values(const parametric::Parameter& parameter) {
  if (is_turn(parameter.quantity)) {
    return {"\u00B0", 1 / kRadiansPerDegree};
  }
  return {std::string(unit_of(parameter)), 1};
}

ShownUnit unit_for_errors(const parametric::Parameter& parameter) {
  switch (parameter.quantity) {
    case parametric::Quantity::step_turn:
    case parametric::Quantity::path_turn:
      return {"\u00B0", 1 / kRadiansPerDegree};
    case parametric::Quantity::duration:
      return {"ms", 1000};
    default:
      return {"mm", 1000};
  }
}

}  // namespace krok::cli::fit
