#include "tools/krok-fit/run.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "core/file.h"
#include "formats/steps/steps.h"
#include "tools/cli/output_kind.h"
#include "tools/cli/output_set.h"
#include "tools/krok-fit/fit_library.h"
#include "tools/krok-fit/fit_plots.h"
#include "tools/krok-fit/fit_report.h"
#include "tools/krok-fit/saved_fit.h"

namespace krok::cli::fit {

namespace {

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
  if (smoothed) take_examples(input, kSmoothedSpacing, parametric::kMaxSmoothed);
  bool same = has_examples_of(input.library, saved->library);
  if (!same && smoothed) {
    take_examples(input, kFormerSmoothedSpacing, rbf::kMaxExamples);
    same = has_examples_of(input.library, saved->library);
  }
  if (!same && !smoothed && input.exact_spacing < kUsualSpacing) {
    take_examples(input, kUsualSpacing, rbf::kMaxExamples);
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
    status = outputs.add((std::filesystem::path(options.plots) / name).string(),
                         [&text = svg](OutputFile& output) { return output.write(text); });
    if (!status) return status;
  }
  return outputs.finish();
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (Status status = check_output_kind(context.output, "-o", registry::Kind::steps); !status) {
    return status.error();
  }
  auto input = read_library(options.library, options.keep_going, context);
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
