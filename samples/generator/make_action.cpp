#include <fmt/format.h>

#include "core/file.h"
#include "core/numbers.h"
#include "formats/bvh/bvh_writer.h"
#include "formats/keys/keys.h"
#include "samples/generator/action.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

// make-action: writes a generated reach or kick as BVH, and its keytimes and contacts beside it.

namespace {

using namespace krok;
using namespace krok::cli;

void declare(CommandOptions& command, samples::ActionOptions& action) {
  command.group("Action");
  command.add("--kind KIND", action.kind,
              choice<samples::ActionKind>(
                  {{"reach", samples::ActionKind::reach}, {"kick", samples::ActionKind::kick}}),
              "reach: a hand goes to a point and back; kick: a foot strikes a ball", "reach");
  command.add(
      "--side SIDE", action.side,
      choice<samples::Side>({{"left", samples::Side::left}, {"right", samples::Side::right}}),
      "Of the hand or the foot: left or right", "right");
  command.add("--target ACROSS,UP,ALONG", action.target, lengths<Vec3>(),
              "Where wrist or ankle come to: to that side, up, and ahead of the other foot's heel; "
              "default: in the middle of what is in reach");
  command.add("--pace", action.pace, number(), "2: twice as fast", readable(action.pace));
  command.group("Actor");
  command.add("--stature", action.stature, number(), "Metres", readable(action.stature));
  command.group("Capture");
  command.add("--rate", action.rate, number(), "Frames per second", readable(action.rate));
}

Result<int> run(ToolContext& context, const samples::ActionOptions& options) {
  const auto action = samples::make_action(options);
  if (!action) return action.error();
  if (action->missed > 1e-3) {
    context.warn("action-reach",
                 fmt::format("the target is missed by {:.0f} mm", 1e3 * action->missed),
                 "move it nearer");
  }
  const Clip& clip = action->clip;
  OutputSet outputs(context);
  Status status = outputs.add(
      context.output, [&](OutputFile& file) { return bvh::write(clip, {.decimals = 5}, file); });
  const std::string& name = context.output;
  if (status && name != "-") {
    status = outputs.add(
        name.substr(0, name.size() - extension(name).size()) + ".keys.json", [&](OutputFile& file) {
          return file.write(keys::write(action->keys, clip.skeleton, clip.duration()));
        });
  }
  if (status) status = outputs.finish();
  if (!status) return status.error();
  context.log(fmt::format("{}: {} frames at {:g} fps, {:.1f} s", name, clip.frame_count(),
                          clip.rate, clip.duration()));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  samples::ActionOptions action;
  ToolSpec spec;
  spec.name = "make-action";
  spec.summary = "Generates a capture of a reach or a kick, with its keytimes and contacts";
  spec.inputs = "";
  spec.examples = {
      {"make-action --target 0.3m,1.2m,0.5m -o reach.bvh",
       "the right hand reaches for a point 30 cm to the side, 1.2 m high and 50 cm ahead"},
      {"make-action --kind kick --target 0.1m,0.3m,0.5m -o kick.bvh", "kicks a ball in the air"},
  };
  spec.declare = [&](CommandOptions& command) { declare(command, action); };
  spec.run = [&](ToolContext& context) { return run(context, action); };
  return run_tool([&spec] { return spec; }, argc, argv);
}
