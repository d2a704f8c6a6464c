#include "tools/krok-blend/options.h"

#include <memory>

#include "core/numbers.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-blend/run.h"
#include "tools/krok-blend/weighted_input.h"
#include "tools/shared/orientation_option.h"
#include "tools/shared/plant_result.h"
#include "tools/shared/role_input.h"

namespace krok::cli::blend {

namespace {

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("inputs IN:WEIGHT", options.inputs,
                  "Motions on the same skeleton (.anim, or captures such as BVH), each with a "
                  "weight: a number, or @FILE.csv with columns generic and weight")
      .required();
  command.group("Time");
  add_keys_option(command, options.keys);
  add_choice<WarpChoice>(
      command, "--warp", options.warp,
      {{"pchip", WarpChoice::pchip}, {"linear", WarpChoice::linear}, {"dtw", WarpChoice::dtw}},
      "Time warp: pchip (between keytimes, continuous speed), linear (between keytimes), or dtw "
      "(aligns similar poses, without keytimes)",
      "HOW", "pchip");
  add_rate(command, "--rate", options.rate, "Frames per second (default: the first motion's)");
  command.group("Space");
  add_choice<AlignChoice>(
      command, "--align", options.align,
      {{"auto", AlignChoice::automatic},
       {"root", AlignChoice::root},
       {"stance", AlignChoice::stance},
       {"none", AlignChoice::none}},
      "Root motion: root (blended relative to the heading, so that turns blend), stance (the same, "
      "and planted feet are locked), auto (stance if all motions have contacts, otherwise root), "
      "none (root transforms are blended in world space)",
      "HOW", "auto");
  command.add_flag("--plant", options.plant, kPlantHelp);
  command.add_flag("--modifier", options.modifier,
                   "Allow weights that do not sum to 1, for additive motions");
  add_map_option(command, options.map);
  command.group("Output");
  command.add_option("--save-warp OUT.csv", options.save_warp,
                     "Write the time warp: the source time in each motion for every frame");
  add_orientation_option(command, options.orientation);
}

Status check(const Options& options) {
  for (const std::string& word : options.inputs) {
    if (const auto input = parse_weighted_input(word); !input) return input.error();
  }
  return {};
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-blend", options, declare, check, run);
  spec.summary = "Blends motions: a weighted sum, time-aligned by keytimes";
  spec.inputs = "IN.anim:WEIGHT...";
  spec.examples = {
      {"krok-blend slow.anim:0.3 fast.anim:0.7 -o brisk.anim", "a blend of two walks"},
      {"krok-blend walk.anim:@out.csv run.anim:@in.csv -o start.anim --save-warp warp.csv",
       "a transition from walk to run, with weight curves over generic time (columns generic, "
       "weight)"},
      {"krok-blend a.anim:0.5 b.anim:0.5 -o c.anim --warp dtw",
       "motions without keytimes, aligned by the similarity of their poses"}};
  return spec;
}

}  // namespace krok::cli::blend
