#include "tools/krok-fit/options.h"

#include "core/numbers.h"
#include "core/quantity.h"
#include "tools/common/option_kinds.h"

namespace krok::fit_tool {

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("library", options.library,
                  "What the library is made of: a library description (JSON)")
      .type_name("IN.json")
      .required();
  command.add_flag(
      "--keep-going", options.keep_going,
      "Leave out motions that do not fit, for their skeleton is another one, and end with "
      "exit code 3");
  add_choice<rbf::Kernel>(command, "--kernel", options.kernel,
                          {{"cubic", rbf::Kernel::cubic},
                           {"linear", rbf::Kernel::linear},
                           {"gaussian", rbf::Kernel::gaussian},
                           {"bspline", rbf::Kernel::bspline},
                           {"wendland", rbf::Kernel::wendland}},
                          "What weights are made of between the examples: cubic, linear, gaussian, "
                          "bspline or wendland",
                          "KERNEL", "cubic")
      .group("Fit");
  command
      .add_option_function(
          "--smooth",
          [&options](const std::string& text) {
            options.smooth = text == "auto" ? std::nullopt : parse_finite(text);
          },
          "0: at an example's parameters the example comes back. More: examples that contradict "
          "each other are averaged, 0.001 hardly, 10 nearly to planes. auto: 0, but for steps that "
          "were found and that the others make much better so")
      .type_name("auto|N")
      .default_str("0")
      .check([](std::string& text) {
        const auto number = parse_finite(text);
        return text == "auto" || (number && *number >= 0 && *number <= 1e6)
                   ? std::string()
                   : "'" + text + "' is neither auto nor a number from 0 to 1000000";
      })
      .group("Fit");
  add_whole(command, "--refine", options.refine,
            "Points to insert at most, 0 for none; otherwise 40 for each parameter", 0, kMaxRefined)
      .group("Fit");
  command
      .add_option("--until", options.until,
                  "The largest error of lengths that is small enough; otherwise each parameter's "
                  "tolerance in the description")
      .type_name("LENGTH")
      .group("Fit");
  add_whole(
      command, "--holdout", options.held_out,
      "Points at which the error is measured and none is inserted; 0 chooses by the number of "
      "parameters",
      0, 100'000)
      .group("Fit");
  add_whole(command, "--seed", options.seed, "Of the points that are looked at", 0, 1'000'000'000)
      .default_str("1")
      .group("Fit");
  command
      .add_flag_callback(
          "--no-polish", [&options] { options.polish = false; },
          "Leave the weights of inserted points as each was found, right at its own point; "
          "otherwise "
          "all are moved together to where the error between them is least, if that helps")
      .group("Fit");
  command
      .add_option("--resume", options.resume,
                  "A library made from the same examples, whose refinement goes on")
      .type_name("IN.steps")
      .group("Fit");
  command
      .add_option("--plots", options.plots,
                  "A folder for charts (SVG): error by inserted points, weights, examples and "
                  "inserted points, measured against asked")
      .type_name("DIR")
      .group("Output");
}

Status check(const Options& options) {
  if (options.until.empty()) return {};
  const auto until = parse_length(options.until);
  if (!until) return until.error();
  if (*until > 0) return {};
  return Error("usage", "--until: the error must be more than 0");
}

}  // namespace krok::fit_tool
