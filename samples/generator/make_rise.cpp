#include <fmt/format.h>

#include "core/file.h"
#include "core/numbers.h"
#include "formats/bvh/bvh_writer.h"
#include "samples/generator/rise.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

// make-rise: writes a generated motion of getting up as BVH.

namespace {

using namespace krok;
using namespace krok::cli;

struct Arguments {
  samples::RiseOptions rise;
  std::string from = "front";
};

void declare(CommandOptions& command, Arguments& arguments) {
  command.group("Motion");
  command.add("--from HOW", arguments.from, words({"front", "back", "side"}),
              "Lying on the front, the back or the left side", "front");
  command.add("--pace", arguments.rise.pace, number(), "2: twice as fast",
              readable(arguments.rise.pace));
  command.group("Actor");
  command.add("--stature", arguments.rise.stature, number(), "Metres",
              readable(arguments.rise.stature));
  command.group("Capture");
  command.add("--rate", arguments.rise.rate, number(), "Frames per second",
              readable(arguments.rise.rate));
}

Result<int> run(ToolContext& context, Arguments& arguments) {
  arguments.rise.from = arguments.from == "back"   ? samples::Lying::back
                        : arguments.from == "side" ? samples::Lying::side
                                                   : samples::Lying::front;
  const auto clip = samples::make_rise(arguments.rise);
  if (!clip) return clip.error();
  const auto write = [&](OutputFile& file) { return bvh::write(*clip, {.decimals = 4}, file); };
  if (Status status = write_output(context, context.output, write); !status) return status.error();
  context.log(fmt::format("{}: gets up from the {}, {} frames at {:g} fps, {:.1f} s",
                          context.output, arguments.from, clip->frame_count(), clip->rate,
                          clip->duration()));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ToolSpec spec;
  spec.name = "make-rise";
  spec.summary = "Generates a capture of someone who gets up from lying, to follow a fall";
  spec.inputs = "";
  spec.examples = {
      {"make-rise --from back -o back.bvh", "sits up, squats and stands"},
      {"make-rise --from front --pace 1.3 -o front.bvh", "over hands and knees, a third faster"},
  };
  spec.declare = [&](CommandOptions& command) { declare(command, arguments); };
  spec.run = [&](ToolContext& context) { return run(context, arguments); };
  return run_tool([&spec] { return spec; }, argc, argv);
}
