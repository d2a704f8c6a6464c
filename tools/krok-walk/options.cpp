#include "tools/krok-walk/options.h"

#include <fmt/format.h>

#include <memory>

#include "core/file.h"
#include "core/quantity.h"
#include "core/text.h"
#include "terrain/spec.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"
#include "tools/krok-walk/run.h"
#include "tools/shared/orientation_option.h"
#include "tools/shared/role_input.h"

namespace krok::cli::walk {

namespace {

void declare_way(CommandOptions& command, Arguments& a) {
  command.group("Where to");
  command.add_option(
      "--path IN", a.path,
      "Path to follow: an SVG, a table (.csv) or .json (formats/path/SPEC.md), another motion, "
      "whose hips' path is taken, or a scene (.gltf, .glb) with an animated node");
  command.add_option("--path-id ID", a.path_id,
                     "Element of the SVG (default: the first path), joint of the motion (the hips) "
                     "or node of the scene (the first that travels)");
  command.add_option("--path-scale LENGTH", a.path_scale, "Length of a unit of the SVG")
      .capture_default_str();
  command.add_option(
      "--prints IN", a.prints,
      "Footprints, .csv or .json (formats/prints/SPEC.md); the walker stands on the first two");
  command
      .add_option("--to X,Z", a.to,
                  "Goal on the ground, as x (to the left of a walker who faces +Z) and z: 2m,6m; "
                  "repeat the option for several in a row")
      .one_each_time();
  command
      .add_option("--from X,Z[,ANGLE]", a.from,
                  "Where --to begins, and which way the walker faces there, from +Z towards +X")
      .default_str("0,0,0deg");
  command.add_option("--save-prints OUT", a.save_prints,
                     "Write the footprints that are walked, .csv or .json, to be edited and handed "
                     "back with --prints");
}

void declare_ground(CommandOptions& command, Arguments& a) {
  command.group("Ground");
  command
      .add_option("--ground IN", a.ground,
                  "A height field (.exr, 16-bit .png), a mesh (.gltf, .glb, .obj), or one of " +
                      std::string(terrain::kSpecForms) +
                      "; stairs and slopes begin 1 m ahead along +Z")
      .capture_default_str();
  command.add_option("--ground-size WIDTHxDEPTH", a.ground_size,
                     "Size of a height field along X and Z; otherwise from its sidecar "
                     "NAME.ground.json (formats/height_field/SPEC.md)");
  command.add_option("--ground-range LOW,HIGH", a.ground_range,
                     "Heights of black and white of a height field, or of 0 and 1: 0,1.5m");
}

void declare_steps(CommandOptions& command, Arguments& a) {
  command.group("Steps");
  command.add_option("--step-length LENGTH", a.step_length,
                     "Length of steps planned on straight paths (default: as in the library)");
  command.add_option("--step-width LENGTH", a.step_width,
                     "Distance of planned footprints across the path (default: as in the library)");
  add_choice<FootSide>(command, "--first", a.first,
                       {{"left", FootSide::left}, {"right", FootSide::right}},
                       "Foot that steps first where footprints are planned", "SIDE", "left");
  add_number(command, "--speed", a.speed,
             "Speed of the steps relative to the library's; footprints with times have theirs")
      .capture_default_str();
  command.add_flag("--adapt", a.adapt,
                   "Take the nearest footprint that can be reached where one cannot, leaving the "
                   "others where they are; reported");
  command.add_flag("--extrapolate", a.extrapolate,
                   "Allow steps outside the range of the examples, where they are unproven");
  command
      .add_option("--clearance LENGTH", a.clearance,
                  "Least height of the swing foot over the ground")
      .capture_default_str();
  command
      .add_option("--stretch LENGTH", a.stretch,
                  "Length by which a leg may grow rather than its knee snap straight")
      .capture_default_str();
  add_map_option(command, a.map);
}

void declare(CommandOptions& command, Arguments& a) {
  command
      .add_option("libraries IN.steps", a.libraries,
                  "Step libraries made by krok-fit, on one skeleton; each step is taken from the "
                  "one whose examples are nearest, the first and the last from libraries of starts "
                  "and stops where there are any")
      .required();
  declare_way(command, a);
  declare_ground(command, a);
  declare_steps(command, a);
  command.group("Output");
  add_rate(command, "--rate", a.rate, "Frames per second (default: the library's)");
  add_orientation_option(command, a.orientation);
  command.add_option("--view OUT.html", a.view,
                     "Write a web page, too, that plays the walk on its ground with its "
                     "footprints, as krok-view does");
}

// Numbers of a text "a,b" or "AxB".
Result<std::vector<double>> quantities(
    const std::string& option, const std::string& text, char between, std::size_t least,
    std::initializer_list<Result<double> (*)(std::string_view)> parsers) {
  std::vector<double> values;
  std::string_view rest = text;
  for (const auto parser : parsers) {
    if (rest.empty()) break;
    const std::size_t end = rest.find(between);
    const auto value = parser(trimmed(rest.substr(0, end)));
    if (!value) {
      return usage(fmt::format("{}: {}", option, value.error().message), value.error().hint);
    }
    values.push_back(*value);
    rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  }
  if (!rest.empty() || values.size() < least) {
    return usage(
        fmt::format("{}: '{}' has {} values", option, text, rest.empty() ? "too few" : "too many"),
        fmt::format("separate them by '{}'", between));
  }
  return values;
}

Status take_length(const char* option, const std::string& text, double least, double most,
                   double& into) {
  const auto length = parse_length(text);
  if (!length) {
    return usage(fmt::format("{}: {}", option, length.error().message), length.error().hint);
  }
  if (!(*length >= least && *length <= most)) {
    return usage(fmt::format("{}: {} is not from {} to {} m", option, text, least, most));
  }
  into = *length;
  return {};
}

Status take_ground(const Arguments& a, Options& options) {
  options.ground = a.ground;
  if (!a.ground_size.empty()) {
    const auto size =
        quantities("--ground-size", a.ground_size, 'x', 2, {parse_length, parse_length});
    if (!size) return size.error();
    options.placement.size = {(*size)[0], (*size)[1]};
  }
  if (!a.ground_range.empty()) {
    const auto range =
        quantities("--ground-range", a.ground_range, ',', 2, {parse_length, parse_length});
    if (!range) return range.error();
    options.placement.range = {(*range)[0], (*range)[1]};
  }
  return {};
}

Status take_way(const Arguments& a, Options& options) {
  const int ways = (a.path.empty() ? 0 : 1) + (a.prints.empty() ? 0 : 1) + (a.to.empty() ? 0 : 1);
  if (ways != 1) {
    return usage(ways == 0 ? "no path is given" : "--path, --prints and --to exclude each other",
                 "give a path with --path, footprints with --prints, or goals with --to X,Z");
  }
  options.path = a.path;
  options.path_id = a.path_id;
  options.prints = a.prints;
  for (const std::string& text : a.to) {
    const auto goal = quantities("--to", text, ',', 2, {parse_length, parse_length});
    if (!goal) return goal.error();
    options.goals.emplace_back((*goal)[0], (*goal)[1]);
  }
  if (!a.from.empty()) {
    if (a.to.empty()) return usage("--from is for --to");
    const auto from =
        quantities("--from", a.from, ',', 2, {parse_length, parse_length, parse_angle});
    if (!from) return from.error();
    options.from = {(*from)[0], (*from)[1]};
    if (from->size() > 2) options.heading = (*from)[2];
  }
  const bool plans = a.prints.empty();
  if (!plans && (!a.step_length.empty() || !a.step_width.empty())) {
    return usage("--step-length and --step-width are for planned footprints, not for --prints");
  }
  const std::string ending = extension(a.save_prints);
  if (!a.save_prints.empty() && ending != ".csv" && ending != ".json") {
    return usage(fmt::format("--save-prints: '{}' is neither .csv nor .json", a.save_prints));
  }
  options.save_prints = a.save_prints;
  options.view = a.view;
  return take_length("--path-scale", a.path_scale, 1e-6, 1e4, options.path_scale);
}

Result<Options> understand(const Arguments& a) {
  Options options;
  options.libraries = a.libraries;
  options.map = a.map;
  options.first = a.first;
  options.rate = a.rate;
  options.adapt = a.adapt;
  options.extrapolate = a.extrapolate;
  options.orientation = a.orientation;
  if (!(a.speed >= 0.1 && a.speed <= 10)) {
    return usage(fmt::format("--speed: {} is not from 0.1 to 10", a.speed));
  }
  options.speed = a.speed;
  if (Status status = take_way(a, options); !status) return status.error();
  if (Status status = take_ground(a, options); !status) return status.error();
  if (Status status = take_length("--stretch", a.stretch, 0, 0.1, options.stretch); !status) {
    return status.error();
  }
  if (Status status = take_length("--clearance", a.clearance, 0, 0.5, options.clearance); !status) {
    return status.error();
  }
  double length = 0;
  if (!a.step_length.empty()) {
    if (Status status = take_length("--step-length", a.step_length, 0.05, 2, length); !status) {
      return status.error();
    }
    options.step_length = length;
  }
  if (!a.step_width.empty()) {
    if (Status status = take_length("--step-width", a.step_width, 0, 1, length); !status) {
      return status.error();
    }
    options.step_width = length;
  }
  return options;
}

}  // namespace

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec = spec_of("krok-walk", arguments, declare, understand, run);
  spec.summary = "Walks a character along footprints, a path or to goals, on any ground";
  spec.inputs = "IN.steps...";
  spec.examples = {
      {"krok-walk walking.steps --to 2m,6m -o walk.anim", "to a place on level ground"},
      {"krok-walk walking.steps --path way.svg --ground hills.exr --save-prints prints.csv "
       "-o walk.anim",
       "along a path drawn in an SVG, over a height field; keeps the footprints"},
      {"krok-walk walking.steps --to 0m,5m --ground stairs:count=8 -o walk.anim --view walk.html",
       "up stairs, with a page to watch it"},
      {"krok-walk level.steps stairs.steps --prints prints.csv --ground "
       "stairs:rise=17cm,run=29cm -o walk.anim",
       "on given footprints up stairs, with steps from two libraries"}};
  return spec;
}

}  // namespace krok::cli::walk
