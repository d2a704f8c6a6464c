#include <fmt/format.h>

#include "core/file.h"
#include "core/numbers.h"
#include "formats/bvh/bvh_writer.h"
#include "samples/generator/gesture.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

// make-gesture: writes a generated gesture as BVH.

namespace {

using namespace krok;
using namespace krok::cli;

struct Arguments {
  samples::GestureOptions gesture;
  std::string kind = "wave";
  std::optional<ClipTime> duration;
};

void declare(CommandOptions& command, Arguments& arguments) {
  command.group("Gesture");
  command.add("--kind KIND", arguments.kind, words({"wave", "limp", "look"}), "wave, limp or look",
              "wave");
  command.add(
      "--side SIDE", arguments.gesture.side,
      choice<samples::Side>({{"left", samples::Side::left}, {"right", samples::Side::right}}),
      "Side of the waving arm, the limping leg or the look: left or right", "right");
  command.add("--duration", arguments.duration, clip_time({}), "Duration; one stride for a limp",
              "3s");
  command.group("Capture");
  command.add("--rate", arguments.gesture.rate, number(), "Frames per second",
              readable(arguments.gesture.rate));
}

Result<int> run(ToolContext& context, Arguments& arguments) {
  samples::GestureOptions& gesture = arguments.gesture;
  gesture.gesture = arguments.kind == "limp"   ? samples::Gesture::limp
                    : arguments.kind == "look" ? samples::Gesture::look
                                               : samples::Gesture::wave;
  if (arguments.duration) gesture.duration = arguments.duration->seconds(gesture.rate);
  const auto clip = samples::make_gesture(gesture);
  if (!clip) return clip.error();
  const auto write = [&](OutputFile& file) { return bvh::write(*clip, {.decimals = 4}, file); };
  if (Status status = write_output(context, context.output, write); !status) return status.error();
  context.log(fmt::format("{}: a {}, {} frames at {:g} fps, {:.1f} s", context.output,
                          arguments.kind, clip->frame_count(), clip->rate, clip->duration()));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ToolSpec spec;
  spec.name = "make-gesture";
  spec.summary = "Generates a capture of a gesture, to layer on a walk of make-walk";
  spec.inputs = "";
  spec.examples = {
      {"make-gesture --kind wave -o wave.bvh", "a standing character raises an arm and waves"},
      {"make-gesture --kind limp --side left --duration 1.2s -o limp.bvh",
       "the trunk motion of one limping stride"},
  };
  spec.declare = [&](CommandOptions& command) { declare(command, arguments); };
  spec.run = [&](ToolContext& context) { return run(context, arguments); };
  return run_tool([&spec] { return spec; }, argc, argv);
}
