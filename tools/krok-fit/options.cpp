#include "tools/krok-fit/options.h"

#include <memory>

#include "core/numbers.h"
#include "core/quantity.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-fit/run.h"

namespace krok::cli::fit {

namespace {

void declare_weights(CommandOptions& command, Options& options) {
  command.group("Fit");
  command
      .add_option_function(
          "--kernel KERNEL",
          [&options](const std::string& text) { options.kernel = rbf::kernel_named(text); },
          "Radial basis function of the weights: cubic, linear, gaussian, bspline or wendland. "
          "auto: cubic, unless another one predicts clips that are left out clearly better")
      .default_str("auto")
      .transform(one_of_words({"auto", "cubic", "linear", "gaussian", "bspline", "wendland"}));
  command
      .add_option_function(
          "--smooth auto|N",
          [&options](const std::string& text) {
            options.smooth = text == "auto" ? std::nullopt : parse_finite(text);
          },
          "Smoothing. 0: examples are reproduced exactly. More: contradictory examples are "
          "averaged, from 0.001 (hardly) to 10 (almost affine). auto: 0, unless smoothing predicts "
          "clips that are left out clearly better; then the most that is not clearly worse than "
          "the "
          "best")
      .default_str("auto")
      .check([](std::string& text) {
        const auto number = parse_finite(text);
        return text == "auto" || (number && *number >= 0 && *number <= 1e6)
                   ? std::string()
                   : "'" + text + "' is neither auto nor a number from 0 to 1000000";
      });
}

void declare_refinement(CommandOptions& command, Options& options) {
  command.group("Fit");
  add_whole(command, "--refine", options.refine,
            "Max number of points to insert, 0 for none (default: 40 per parameter)", 0,
            kMaxRefined);
  command.add_option("--until LENGTH", options.until,
                     "Max accepted error of length parameters (default: each parameter's tolerance "
                     "in the description)");
  add_whole(
      command, "--holdout", options.held_out,
      "Number of held-out points for measuring the error; 0: chosen by the number of parameters", 0,
      100'000);
  add_whole(command, "--seed", options.seed, "Random seed of the sampled points", 0, 1'000'000'000)
      .default_str("1");
  command.add_flag_callback(
      "--no-polish", [&options] { options.polish = false; },
      "Do not optimise the weights of inserted points jointly, which reduces the error between "
      "them");
  command.add_option("--resume IN.steps", options.resume,
                     "Continue the refinement of a library made from the same examples");
}

}  // namespace

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("library IN.json", options.library,
                  "Library description (JSON): examples and parameters")
      .required();
  command.add_flag(
      "--keep-going", options.keep_going,
      "Leave out unsuitable motions, such as those on another skeleton, and exit with code 3");
  declare_weights(command, options);
  declare_refinement(command, options);
  command.group("Output");
  command.add_option("--plots DIR", options.plots,
                     "Write charts (SVG) to this folder: error by inserted points, weights, "
                     "examples and inserted points, measured by requested parameters");
}

Status check(const Options& options) {
  if (options.until.empty()) return {};
  const auto until = parse_length_with_unit(options.until);
  if (!until)
    return Error(until.error().code, "--until: " + until.error().message, until.error().hint);
  if (*until > 0) return {};
  return Error("usage", "--until: the error must be greater than 0");
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-fit", options, declare, check, run);
  spec.summary = "Fits a step library to example motions, with a measured error";
  spec.details = "krok-synth then makes motions for any parameters between them.";
  spec.inputs = "LIBRARY.json";
  spec.examples = {
      {"krok-fit walking.json -o walking.steps",
       "uses the examples in the description and refines until the tolerances are met"},
      {"krok-fit walking.json -o walking.steps --refine 80 --until 0.5mm --plots charts",
       "inserts up to 80 points until lengths are within 0.5 mm, and writes charts"},
      {"krok-fit walking.json --resume walking.steps --refine 160 -o better.steps",
       "continues the refinement of an earlier run"}};
  spec.exit_partly = "with --keep-going: some motions were left out, the library was written";
  spec.report_name = "--report";
  return spec;
}

}  // namespace krok::cli::fit
