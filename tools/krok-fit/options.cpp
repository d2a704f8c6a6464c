#include "tools/krok-fit/options.h"

#include <memory>

#include "formats/io/formats.h"
#include "tools/cli/option_kinds.h"

namespace krok::cli::fit {

namespace {

void declare_weights(CommandOptions& command, Options& o) {
  command.group("Fit");
  const auto kernel = words({"auto", "cubic", "linear", "gaussian", "bspline", "wendland"});
  command.add("--kernel KERNEL", o.kernel,
              ValueKind<std::optional<rbf::Kernel>>{
                  kernel.name, "KERNEL",
                  [kernel](const std::string& text) -> Result<std::optional<rbf::Kernel>> {
                    const auto word = kernel.read(text);
                    if (!word) return word.error();
                    return rbf::kernel_named(*word);
                  },
                  kernel.words},
              "Radial basis function of the weights: cubic, linear, gaussian, bspline or wendland. "
              "auto: cubic, unless another one predicts clips that are left out clearly better",
              "auto");
  command.add("--smoothing auto|N", o.smooth, or_word("auto", number({0, 1e6})),
              "Smoothing. 0: examples are reproduced exactly. More: contradictory examples are "
              "averaged, from 0.001 (hardly) to 10 (almost affine). auto: 0, unless smoothing "
              "predicts clips that are left out clearly better; then the most that is not clearly "
              "worse than the best",
              "auto");
}

void declare_refinement(CommandOptions& command, Options& o) {
  command.group("Fit");
  command.add("--refine", o.refine, whole(0, kMaxRefined),
              "Max number of points to insert, 0 for none (default: 40 per parameter); of sculpted "
              "poses, held-out poses that become examples, the worst first (default: none)");
  command.add("--max-error", o.until, length_with_unit(kPositive),
              "Max accepted error of length parameters (default: each parameter's tolerance in the "
              "description), or of sculpted poses");
  command.add("--holdout", o.held_out, whole(0, 100'000),
              "Number of held-out points for measuring the error; 0: chosen by the number of "
              "parameters");
  command.add("--seed", o.seed, whole(0, 1'000'000'000), "Random seed of the sampled points", "1");
  command.add_no_flag("--no-polish", o.polish,
                      "Do not optimise the weights of inserted points jointly, which reduces the "
                      "error between them");
  command.add_option("--resume IN.steps", o.resume,
                     "Continue the refinement of a library made from the same examples");
}

void declare(CommandOptions& command, Options& options) {
  command
      .add_option(
          "library IN", options.inputs,
          "Library description (JSON): examples and parameters; or motions, or a folder of them: "
          "the steps of walks, or of runs if there are no walks, become a library by length and "
          "turn, mirrored ones, too; or sculpted poses of a model (formats/correctives/SPEC.md), "
          "which become correctives for krok-skin")
      .required();
  command.add_flag(
      "--keep-going", options.keep_going,
      "Leave out unsuitable motions, such as those on another skeleton, and exit with code 3");
  declare_weights(command, options);
  declare_refinement(command, options);
  command.group("Output");
  command.add("--plot OUT_DIR", options.plots, output({}),
              "Write charts (SVG) to this folder: error by inserted points, weights, "
              "examples and inserted points, measured by requested parameters");
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-fit", options, declare, nullptr, run);
  spec.summary = "Fits a step library to example motions, with a measured error";
  spec.details =
      "krok-synth then makes motions for any parameters between them. Of sculpted poses of a model "
      "it makes correctives, morph targets by pose, which krok-skin adds.";
  spec.inputs = "LIBRARY.json|IN...";
  spec.folder_endings = io::motion_endings();
  spec.each_animation = [](const std::string&) { return true; };
  spec.examples = {
      {"krok-fit walks/ -o walking.steps",
       "the steps of all walks in a folder, by their length and turn"},
      {"krok-fit walking.json -o walking.steps",
       "uses the examples in the description and refines until the tolerances are met"},
      {"krok-fit walking.json -o walking.steps --refine 80 --max-error 0.5mm --plot charts",
       "inserts up to 80 points until lengths are within 0.5 mm, and writes charts"},
      {"krok-fit walking.json --resume walking.steps --refine 160 -o better.steps",
       "continues the refinement of an earlier run"},
      {"krok-fit correctives.json -o hero.correctives",
       "correctives that keep the volume of bent joints, with their error on held-out poses"}};
  spec.exit_partly = "with --keep-going: some motions were left out, the library was written";
  spec.report_name = "--report";
  return spec;
}

}  // namespace krok::cli::fit
