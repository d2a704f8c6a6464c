#include "tools/krok-walk/options.h"

#include <fmt/format.h>

#include <memory>

#include "terrain/spec.h"

namespace krok::cli::walk {

namespace {

constexpr std::size_t kMaxPaces = 32;

void declare_way(CommandOptions& command, Options& o) {
  command.group("Where to");
  command
      .add_option(
          "--path IN", o.path,
          "Path to follow: an SVG, a table (.csv) or .json (formats/path/SPEC.md), another motion, "
          "whose hips' path is taken, or a scene (.gltf, .glb) with an animated node")
      .not_with({"--prints", "--goal"});
  command.add_option("--path-id ID", o.path_id,
                     "Element of the SVG (default: the first path), joint of the motion (the hips) "
                     "or node of the scene (the first that travels)");
  command.add("--path-scale", o.path_scale, length({1e-6, 1e4}), "Length of a unit of the SVG",
              "1cm");
  command
      .add_option("--prints IN", o.prints,
                  "Footprints, .csv or .json (formats/prints/SPEC.md); the walker stands on the "
                  "first two")
      .not_with("--goal");
  command.add("--goal X,Z", o.goals, lengths<Vec2>(),
              "Goal on the ground, as x (to the left of a walker who faces +Z) and z: 2m,6m; "
              "repeat the option for several in a row");
  command
      .add("--start X,Z[,ANGLE]", o.from,
           numbers_as<std::array<double, 3>>({length(), length(), angle()}, 2),
           "Where --goal begins, and which way the walker faces there, from +Z towards +X",
           "0,0,0deg")
      .only_with("--goal");
  command.add("--save-prints OUT", o.save_prints, output({".csv", ".json"}),
              "Write the footprints that are walked, .csv or .json, to be edited and handed back "
              "with --prints");
}

void declare_ground(CommandOptions& command, Options& o) {
  command.group("Ground");
  add_ground_option(command, o.ground,
                    "A height field (.exr, 16-bit .png), a mesh (.gltf, .glb, .obj), or one of " +
                        std::string(terrain::kSpecForms) +
                        "; stairs and slopes begin 1 m ahead along +Z",
                    "level");
}

void declare_steps(CommandOptions& command, Options& o) {
  command.group("Steps");
  command
      .add("--step-length", o.step_length, length({0.05, 2}),
           "Length of steps planned on straight paths (default: as in the library)")
      .not_with("--prints");
  command
      .add("--pace SPEED[,SPEED...]", o.pace,
           numbers(std::vector(kMaxPaces, number({0.1, 12}, "m/s")), 1),
           "Speed along the path in m/s or km/h, or several that follow one another from its start "
           "to its "
           "end: 1.4m/s,3m/s,1.4m/s; steps are as long as those of the libraries at that speed, "
           "walked or run")
      .not_with({"--prints", "--step-length"});
  command
      .add("--step-width", o.step_width, length({0, 1}),
           "Distance of planned footprints across the path (default: as in the library)")
      .not_with("--prints");
  command.add("--first SIDE", o.first,
              choice<FootSide>({{"left", FootSide::left}, {"right", FootSide::right}}),
              "Foot that steps first where footprints are planned", "left");
  ValueKind<double> times = number({0.1, 10});
  times.read = [read = times.read](const std::string& text) -> Result<double> {
    auto value = read(text);
    const auto pace = number({0, 1000}, "m/s").read(text);
    if (value || !pace || text.find('/') == std::string::npos) return value;
    return usage(fmt::format("'{}' is a speed, not a factor", text), "write --pace " + text);
  };
  command.add("--speed", o.speed, times,
              "Speed of the steps relative to the library's; footprints with times have theirs",
              "1");
  command.add_flag("--adapt", o.adapt,
                   "Take the nearest footprint that can be reached where one cannot, leaving the "
                   "others where they are; reported");
  command.add_flag("--extrapolate", o.extrapolate,
                   "Allow steps outside the range of the examples, where they are unproven");
  command.add("--clearance", o.clearance, length({0, 0.5}),
              "Least height of the swing foot over the ground", "15mm");
  command.add_flag(
      "--strict", o.strict,
      "Exit with 1 if a step is not as it should be: a foot misses its print or is lower "
      "than --clearance, the hips are beside the feet, an ankle bends too far, the speed is not "
      "--pace (otherwise a warning)");
  command.add("--stretch", o.stretch, length({0, 0.1}),
              "Length by which a leg may grow rather than its knee snap straight", "0");
  command.add("--variation", o.variation, number({0, 1}),
              "How much of single real steps each step takes where the library averages many: 0 "
              "walks like the average (of --style), 1 like the examples",
              "0.85");
  command.add("--seed", o.seed, whole(0, 1'000'000'000),
              "Which of several suitable examples steps take", "1");
  command.add_option("--style NAME", o.style,
                     "Walk in this style of the libraries, or as in captures whose names contain "
                     "this, in any case");
  add_map_option(command, o.map);
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option("libraries IN.steps", o.libraries,
                  "Step libraries made by krok-fit, on one skeleton; each step is taken from the "
                  "one whose examples are nearest, the first and the last from libraries of starts "
                  "and stops where there are any")
      .required();
  declare_way(command, o);
  declare_ground(command, o);
  declare_steps(command, o);
  command.group("Output");
  command.add("--rate", o.rate, rate(), "Frames per second (default: the library's)");
  add_orientation_option(command, o.orientation);
  command.add("--save-page OUT.html", o.view, output({".html", ".htm"}),
              "Write a web page, too, that plays the walk on its ground with its footprints, as "
              "krok-view does");
}

Status check(const Options& o) {
  if (!o.path.empty() || !o.prints.empty() || !o.goals.empty()) return {};
  return usage("no path is given",
               "give a path with --path, footprints with --prints, or goals with --goal X,Z");
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-walk", options, declare, check, run);
  spec.summary = "Walks a character along footprints, a path or to goals, on any ground";
  spec.inputs = "IN.steps...";
  spec.writes = registry::Kind::anim;
  spec.exit_no = "with --strict: a step is not as it should be";
  spec.examples = {
      {"krok-walk walking.steps --goal 2m,6m -o walk.anim", "to a place on level ground"},
      {"krok-walk walking.steps --path way.svg --ground hills.exr --save-prints prints.csv "
       "-o walk.anim",
       "along a path drawn in an SVG, over a height field; keeps the footprints"},
      {"krok-walk walking.steps --goal 0m,5m --ground stairs:count=8 -o walk.anim --save-page "
       "walk.html",
       "up stairs, with a page to watch it"},
      {"krok-walk walking.steps running.steps --goal 0m,30m --pace 1.4m/s,3m/s,1.4m/s -o run.anim",
       "from a walk to a run and back, with steps from a library of each"},
      {"krok-walk level.steps stairs.steps --prints prints.csv --ground "
       "stairs:rise=17cm,run=29cm -o walk.anim",
       "on given footprints up stairs, with steps from two libraries"}};
  return spec;
}

}  // namespace krok::cli::walk
