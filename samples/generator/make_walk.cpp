#include <fmt/format.h>

#include "core/file.h"
#include "core/quantity.h"
#include "formats/bvh/bvh_writer.h"
#include "samples/generator/foot_slides.h"
#include "samples/generator/ground_truth.h"
#include "samples/generator/rig.h"
#include "samples/generator/walk.h"
#include "tools/cli/one_of.h"
#include "tools/cli/tool.h"

// make-walk: writes a generated walk as BVH, and its ground truth to a sidecar.

namespace {

using namespace krok;
using namespace krok::cli;

// A micrometre, also for rotations at the end of a leg.
constexpr int kDecimals = 4;

struct Arguments {
  samples::WalkOptions walk;
  std::string stature, step_length, step_width, turn, rise, noise_angle, noise_position, slide;
  std::string ground = "stairs";
  std::string first = "left";
  std::string rig = "hips";
  std::string contacts;
};

void declare(CommandOptions& command, Arguments& arguments) {
  samples::WalkOptions& walk = arguments.walk;
  const auto quantity = [&](const char* name, std::string& text, const char* unit,
                            const char* fallback, const char* help) {
    command.add_option(name, text, help).type_name(unit).default_str(fallback).group("Walk");
  };
  command.add_option("--steps", walk.steps, "Number of steps")
      .type_name("N")
      .capture_default_str()
      .group("Walk");
  quantity("--step-length", arguments.step_length, "LENGTH", "0.7m",
           "Heel-to-heel distance along the path");
  quantity("--step-width", arguments.step_width, "LENGTH", "0.1m",
           "Distance between the heels across the path");
  quantity("--turn", arguments.turn, "ANGLE", "0deg",
           "Heading change per step, positive to the left");
  quantity("--rise", arguments.rise, "LENGTH", "0m", "Height gained per step, negative downwards");
  command.add_option("--ground", arguments.ground, "Ground of a rise: stairs or slope")
      .transform(one_of_words({"stairs", "slope"}))
      .type_name("KIND")
      .capture_default_str()
      .group("Walk");
  command.add_option("--cadence", walk.cadence, "Steps per minute; 0: from the step length")
      .type_name("N")
      .capture_default_str()
      .group("Walk");
  command.add_flag("--from-standing", walk.from_standing, "Start and end standing, not in mid-walk")
      .group("Walk");
  command.add_flag("--backward", walk.backward, "Walk backwards: the walk in reverse")
      .group("Walk");
  command.add_option("--first", arguments.first, "The foot of the first step: left or right")
      .transform(one_of_words({"left", "right"}))
      .type_name("SIDE")
      .capture_default_str()
      .group("Walk");
  quantity("--stature", arguments.stature, "LENGTH", "1.75m", "Height of the actor");
  command
      .add_option("--rig", arguments.rig,
                  "Where the motion is: hips (the root), static-root (hips below a root at the "
                  "origin), ground-root (hips above a root on the ground) or lying (hips, with a "
                  "lying reference pose)")
      .transform(one_of_words({"hips", "static-root", "ground-root", "lying"}))
      .type_name("RIG")
      .capture_default_str()
      .group("Capture");
  command.add_option("--rate", walk.rate, "Frames per second")
      .type_name("N")
      .capture_default_str()
      .group("Capture");
  const auto noise = [&](const char* name, std::string& text, const char* unit,
                         const char* fallback, const char* help) {
    command.add_option(name, text, help).type_name(unit).default_str(fallback).group("Capture");
  };
  noise("--noise-angle", arguments.noise_angle, "ANGLE", "0deg",
        "Standard deviation of joint rotations");
  noise("--noise-position", arguments.noise_position, "LENGTH", "0mm",
        "Standard deviation of the root position");
  noise("--slide", arguments.slide, "LENGTH", "0mm",
        "How far feet slide over each stance, in a random direction; the ground truth is without");
  command.add_option("--seed", walk.seed, "Random seed of noise and slides")
      .type_name("N")
      .capture_default_str()
      .group("Capture");
  command
      .add_option("--contacts", arguments.contacts,
                  "Output file for the ground truth; default: NAME.contacts.json")
      .type_name("FILE")
      .group("Capture");
}

using Parser = Result<double> (*)(std::string_view);

Status set(const std::string& text, Parser parse, double& value) {
  if (text.empty()) return {};
  Result<double> parsed = parse(text);
  if (!parsed) return std::move(parsed).error();
  value = *parsed;
  return {};
}

Status read_quantities(Arguments& arguments) {
  samples::WalkOptions& walk = arguments.walk;
  const struct {
    const std::string& text;
    Parser parse;
    double& value;
  } quantities[] = {
      {arguments.stature, parse_length, walk.stature},
      {arguments.step_length, parse_length, walk.step_length},
      {arguments.step_width, parse_length, walk.step_width},
      {arguments.turn, parse_angle, walk.turn},
      {arguments.rise, parse_length, walk.rise},
      {arguments.noise_angle, parse_angle, walk.noise_angle},
      {arguments.noise_position, parse_length, walk.noise_position},
  };
  for (const auto& quantity : quantities) {
    if (Status status = set(quantity.text, quantity.parse, quantity.value); !status) return status;
  }
  walk.ground = arguments.ground == "slope" ? samples::Ground::slope : samples::Ground::stairs;
  walk.first_side = arguments.first == "right" ? samples::Side::right : samples::Side::left;
  return {};
}

samples::Rig rig_of(const std::string& word) {
  if (word == "static-root") return samples::Rig::static_root;
  if (word == "ground-root") return samples::Rig::ground_root;
  return word == "lying" ? samples::Rig::lying : samples::Rig::hips;
}

// walk.bvh -> walk.contacts.json
std::string contacts_path(const std::string& capture) {
  return capture.substr(0, capture.size() - extension(capture).size()) + ".contacts.json";
}

Result<int> run(ToolContext& context, Arguments& arguments) {
  if (Status status = read_quantities(arguments); !status) return std::move(status).error();
  Result<samples::Walk> walk = samples::make_walk(arguments.walk);
  if (!walk) return std::move(walk).error();

  double slide = 0;
  if (Status status = set(arguments.slide, parse_length, slide); !status) {
    return std::move(status).error();
  }
  if (!(slide >= 0 && slide <= 0.2)) {
    return Error("walk-option", fmt::format("slide is {:.6g} m, outside 0 to 0.2 m", slide),
                 "give a value within the range");
  }
  if (slide > 0) walk->clip = samples::with_slides(*walk, slide, arguments.walk.seed);

  Result<OutputFile> capture = OutputFile::create(context.output, context.output_options());
  if (!capture) return std::move(capture).error();
  bvh::WriteOptions options;
  options.decimals = kDecimals;
  if (Status status =
          bvh::write(samples::with_rig(walk->clip, rig_of(arguments.rig)), options, *capture);
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
