#include "tools/krok-fit/options.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/file.h"
#include "core/result.h"
#include "fit/refine.h"
#include "formats/io/inputs.h"
#include "formats/steps/steps.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/report.h"
#include "tools/krok-fit/corrective_fit.h"
#include "tools/krok-fit/fit_library.h"
#include "tools/krok-fit/fit_report.h"
#include "tools/krok-fit/library_input.h"

namespace krok::cli::fit {

namespace {

using krok::fit::ParameterError;
using krok::fit::RefineMetrics;

// Missing members or wrong types throw; read_refinement() catches all.
std::vector<ParameterError> errors_of(const Json& json, const LibraryInput& input) {
  std::vector<ParameterError> errors;
  for (const library::ParameterEntry& entry : input.description.parameters) {
    const Json& one = json.at(entry.name);
    errors.push_back({one.at("largest").get<double>(), one.at("mean").get<double>(),
                      one.at("most_95").get<double>()});
  }
  return errors;
}

RefineMetrics metrics_of(const Json& json, const LibraryInput& input) {
  RefineMetrics metrics;
  metrics.within = errors_of(json.at("within"), input);
  metrics.outside = errors_of(json.at("extrapolated"), input);
  metrics.largest = json.at("largest_of_range").get<double>();
  metrics.mean_square = json.at("mean_square_of_range").get<double>();
  metrics.failed = json.at("not_measured").get<int>();
  metrics.least_weight = json.at("least_weight").get<double>();
  metrics.largest_weight = json.at("largest_weight").get<double>();
  metrics.roughness = json.at("roughness").get<double>();
  metrics.condition = json.at("condition").get<double>();
  return metrics;
}

krok::fit::Refusal refusal_named(const std::string& name) {
  using krok::fit::Refusal;
  for (const Refusal refusal :
       {Refusal::weights, Refusal::residual, Refusal::near, Refusal::system}) {
    if (krok::fit::refusal_name(refusal) == name) return refusal;
  }
  return Refusal::growth;
}

int count_of(const Json& json) {
  const int count = json.get<int>();
  if (count < 0) throw std::out_of_range("a negative number");
  return count;
}

// Whether the rounds match the points, as refinement counts them. A forged report could otherwise
// claim any number of points, each of which takes time.
bool adds_up(const krok::fit::Refined& refined) {
  std::int64_t inserted = 0, refused = 0;
  for (const krok::fit::RefineRound& round : refined.rounds) {
    if (round.inserted > krok::fit::RefineOptions().points_a_round) return false;
    inserted += round.inserted;
    refused += round.refused;
  }
  const auto rounds = static_cast<int>(refined.rounds.size());
  return inserted == refined.function.inserted() && inserted <= kMaxRefined &&
         refused == static_cast<std::int64_t>(refined.refused.size()) &&
         std::ranges::all_of(refined.refused,
                             [&](const auto& point) { return point.round < rounds; });
}

krok::fit::Refined refinement_of(const Json& json, const LibraryInput& input,
                                 const rbf::WeightFunction& function) {
  krok::fit::Refined refined;
  refined.function = function;
  refined.example_error = json.at("example_error_of_range").get<double>();
  refined.before = metrics_of(json.at("before"), input);
  for (const Json& entry : json.at("rounds")) {
    krok::fit::RefineRound round;
    round.inserted = count_of(entry.at("inserted"));
    round.refused = count_of(entry.at("refused"));
    round.by_point = count_of(entry.at("by_other_parameters"));
    round.sought = entry.at("sought_of_range").get<double>();
    round.after = metrics_of(entry.at("after"), input);
    refined.rounds.push_back(std::move(round));
  }
  for (const Json& entry : json.at("refused_points")) {
    refined.refused.push_back(
        {count_of(entry.at("round")), entry.at("point").get<std::vector<double>>(),
         refusal_named(entry.at("reason").get<std::string>()), entry.at("value").get<double>()});
    if (refined.refused.back().point.size() != input.lower.size()) {
      throw std::out_of_range("a point of other dimensions");
    }
  }
  if (const auto polished = json.find("polished"); polished != json.end()) {
    refined.polished = {polished->at("found_rows").get<std::vector<double>>(),
                        metrics_of(polished->at("after"), input)};
    if (refined.polished->found_rows.size() != function.inserted_rows.size()) {
      throw std::out_of_range("rows of other points");
    }
  }
  if (!adds_up(refined)) throw std::out_of_range("other points");
  return refined;
}

// Reads the refinement state from a fitted library's report `text`, to resume it. Code fit-resume
// if there is none, or it does not match the parameters or points.
Result<krok::fit::Refined> read_refinement(const std::string& text, const LibraryInput& input,
                                           const rbf::WeightFunction& function) {
  try {
    return refinement_of(parse_ordered_json(text), input, function);
  } catch (const std::exception&) {
    return Error("fit-resume", "the report has no refinement state for these parameters and points",
                 "fit without --resume");
  }
}

bool has_examples_of(const parametric::Library& library, const parametric::Library& saved) {
  return saved.parameters == library.parameters &&
         std::ranges::equal(library.examples, saved.examples,
                            [](const parametric::Example& a, const parametric::Example& b) {
                              return a.name == b.name && a.parameters == b.parameters;
                            });
}

// The refinement state of a library with the same examples.
Result<krok::fit::Refined> resumed(const std::string& path, LibraryInput& input,
                                   ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  const auto saved = steps::read(file->bytes());
  if (!saved) return Error(saved.error()).in_file(path);
  const bool smoothed = saved->weights && saved->weights->smoothing > 0;
  if (smoothed) take_smoothed_examples(input);
  bool same = has_examples_of(input.library, saved->library);
  if (!same && smoothed) {
    take_examples(input, kFormerSmoothedSpacing);
    same = has_examples_of(input.library, saved->library);
  }
  if (!same && !smoothed && input.exact_spacing < kUsualSpacing) {
    take_examples(input, kUsualSpacing);
    same = has_examples_of(input.library, saved->library);
  }
  if (!same || !saved->weights) {
    return Error("fit-resume", "made from other examples or for other parameters",
                 "fit without --resume")
        .in_file(path);
  }
  auto refined = read_refinement(saved->report, input, *saved->weights);
  if (!refined) return std::move(refined).error().in_file(path);
  return refined;
}

Status write_results(const Options& options, const LibraryInput& input, const FittedLibrary& fitted,
                     ToolContext& context) {
  steps::StepsFile file;
  file.library = input.library;
  file.weights = fitted.refined.function;
  file.report = json_text(saved_json(input, fitted));
  file.provenance = context.provenance();
  OutputSet outputs(context);
  Status status = outputs.add(context.output,
                              [&](OutputFile& output) { return steps::write(file, {}, output); });
  if (!status || options.plots.empty()) return status ? outputs.finish() : status;
  const auto charts = make_charts(input, fitted);
  if (!charts) return charts.error();
  std::error_code failed;
  std::filesystem::create_directories(options.plots, failed);
  if (failed) {
    return Error("file-unwritable", "cannot create the folder for charts: " + failed.message())
        .in_file(options.plots);
  }
  for (const auto& [name, svg] : *charts) {
    status = outputs.add((std::filesystem::path(options.plots) / name).string(), svg);
    if (!status) return status;
  }
  return outputs.finish();
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (options.inputs.size() == 1 && describes_poses(options.first())) {
    return run_correctives(options, context);
  }
  std::error_code unknown;
  if (options.first() != "-" &&
      !std::filesystem::exists(io::address_of(options.first()).file, unknown)) {
    return Error("file-missing", "no such file", "check the path").in_file(options.first());
  }
  Status kind = check_output_kind(context.output, "-o", registry::Kind::steps);
  if (!kind) return kind.error();
  auto input = read_library(options.inputs, options.keep_going, context);
  if (!input) return input.error();
  std::optional<krok::fit::Refined> start;
  if (!options.resume.empty()) {
    auto saved = resumed(options.resume, *input, context);
    if (!saved) return saved.error();
    start = *std::move(saved);
  }
  WeightsChoice choice;
  if (!start) {
    choice = choose_weights(*input, options, context);
  } else {
    choice.kernel = start->function.kernel;
    choice.smoothing = start->function.smoothing;
  }
  const auto fitted =
      fit_library(*input, options, std::move(choice), start ? &*start : nullptr, context);
  if (!fitted) return fitted.error();
  if (Status status = write_results(options, *input, *fitted, context); !status) {
    return status.error();
  }
  context.report.result = report_json(*input, *fitted);
  say_report(*input, *fitted, context);
  return input->refused.empty() ? kExitDone : kExitPartly;
}

}  // namespace krok::cli::fit
