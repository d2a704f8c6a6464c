#include <fmt/format.h>

#include <limits>

#include "core/file.h"
#include "formats/bvh/bvh_writer.h"
#include "samples/generator/foot_slides.h"
#include "samples/generator/ground_truth.h"
#include "samples/generator/rig.h"
#include "samples/generator/walk.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/tool.h"

// make-walk: writes a generated walk as BVH, and its ground truth to a sidecar.

namespace {

using namespace krok;
using namespace krok::cli;

// A micrometre, also for rotations at the end of a leg.
constexpr int kDecimals = 4;

struct Arguments {
  samples::WalkOptions walk;
  double slide = 0;  // metres
  samples::Rig rig = samples::Rig::hips;
  std::string contacts;
};

void declare(CommandOptions& command, Arguments& arguments) {
  samples::WalkOptions& walk = arguments.walk;
  command.group("Walk");
  command.add("--steps", walk.steps, whole(-1'000'000, 1'000'000), "Number of steps", "8");
  command.add("--step-length", walk.step_length, length(), "Heel-to-heel distance along the path",
              "0.7m");
  command.add("--step-width", walk.step_width, length(),
              "Distance between the heels across the path", "0.1m");
  command.add("--turn", walk.turn, angle(), "Heading change per step, positive to the left",
              "0deg");
  command.add("--rise", walk.rise, length(), "Height gained per step, negative downwards", "0m");
  command.add("--ground KIND", walk.ground,
              choice<samples::Ground>(
                  {{"stairs", samples::Ground::stairs}, {"slope", samples::Ground::slope}}),
              "Ground of a rise: stairs or slope", "stairs");
  command.add("--cadence", walk.cadence, number(), "Steps per minute; 0: from the step length",
              "0");
  command.add_flag("--from-standing", walk.from_standing,
                   "Start and end standing, not in mid-walk");
  command.add_flag("--backward", walk.backward, "Walk backwards: the walk in reverse");
  command.add(
      "--first SIDE", walk.first_side,
      choice<samples::Side>({{"left", samples::Side::left}, {"right", samples::Side::right}}),
      "The foot of the first step: left or right", "left");
  command.add("--stature", walk.stature, length(), "Height of the actor", "1.75m");
  command.group("Capture");
  command.add("--rig RIG", arguments.rig,
              choice<samples::Rig>({{"hips", samples::Rig::hips},
                                    {"static-root", samples::Rig::static_root},
                                    {"ground-root", samples::Rig::ground_root},
                                    {"lying", samples::Rig::lying}}),
              "Where the motion is: hips (the root), static-root (hips below a root at the "
              "origin), ground-root (hips above a root on the ground) or lying (hips, with a lying "
              "reference pose)",
              "hips");
  command.add("--rate", walk.rate, number(), "Frames per second", "60");
  command.add("--noise-angle", walk.noise_angle, angle(), "Standard deviation of joint rotations",
              "0deg");
  command.add("--noise-position", walk.noise_position, length(),
              "Standard deviation of the root position", "0mm");
  command.add("--slide", arguments.slide, length({0, 0.2}),
              "How far feet slide over each stance, in a random direction; the ground truth is "
              "without",
              "0mm");
  command.add("--seed", walk.seed, whole(0, std::numeric_limits<long long>::max()),
              "Random seed of noise and slides", "1");
  command.add_option("--contacts FILE", arguments.contacts,
                     "Output file for the ground truth; default: NAME.contacts.json");
}

// walk.bvh -> walk.contacts.json
std::string contacts_path(const std::string& capture) {
  return capture.substr(0, capture.size() - extension(capture).size()) + ".contacts.json";
}

Result<int> run(ToolContext& context, Arguments& arguments) {
  Result<samples::Walk> walk = samples::make_walk(arguments.walk);
  if (!walk) return std::move(walk).error();

  if (arguments.slide > 0) {
    walk->clip = samples::with_slides(*walk, arguments.slide, arguments.walk.seed);
  }

  Result<OutputFile> capture = OutputFile::create(context.output, context.output_options());
  if (!capture) return std::move(capture).error();
  bvh::WriteOptions options;
  options.decimals = kDecimals;
  if (Status status = bvh::write(samples::with_rig(walk->clip, arguments.rig), options, *capture);
      !status) {
    return std::move(status).error();
  }
  const std::string truth = samples::ground_truth_json(*walk, base_name(context.output));
  std::string truth_path = arguments.contacts;
  if (truth_path.empty() && context.output != "-") truth_path = contacts_path(context.output);
  if (!truth_path.empty()) {
    if (Status status = write_file(truth_path, truth, context.output_options()); !status) {
      return std::move(status).error();
    }
    context.wrote(truth_path);
  }
  if (Status status = capture->commit(); !status) return std::move(status).error();
  context.wrote(context.output);
  context.log(fmt::format("{}: {} steps, {} frames at {:g} fps, {:.1f} s", context.output,
                          arguments.walk.steps, walk->clip.frame_count(), walk->clip.rate,
                          walk->clip.duration()));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ToolSpec spec;
  spec.name = "make-walk";
  spec.summary = "Generates a capture of a walk, with ground-truth contacts";
  spec.inputs = "";
  spec.examples = {
      {"make-walk -o walk.bvh", "eight steps cut out of a steady walk"},
      {"make-walk --turn 15deg --steps 6 --step-length 60cm -o turn.bvh",
       "a quarter turn to the left"},
      {"make-walk --rise 16cm --step-length 30cm --from-standing -o stairs.bvh",
       "up a flight of stairs"},
  };
  spec.declare = [&](CommandOptions& command) { declare(command, arguments); };
  spec.run = [&](ToolContext& context) { return run(context, arguments); };
  return run_tool([&spec] { return spec; }, argc, argv);
}
