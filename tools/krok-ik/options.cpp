#include "tools/krok-ik/options.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <tuple>

#include "core/file.h"
#include "core/numbers.h"
#include "core/quantity.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"
#include "tools/krok-ik/run.h"
#include "tools/shared/orientation_option.h"
#include "tools/shared/planting.h"
#include "tools/shared/role_input.h"

namespace krok::cli::ik {

namespace {

void declare_goals(CommandOptions& command, Arguments& a) {
  command.group("Goals");
  command.add_option("--goals IN.json", a.goals, "Goals (.json, formats/goals/SPEC.md)");
  command.add_option("--ground IN", a.ground,
                     "Heights of goals in the world are over this ground, as for krok-walk: a "
                     "mesh, a height field, stairs:rise=17cm,run=29cm, slope:12deg, ...");
  command
      .add_option("--reach JOINT=X,Y,Z@TIME", a.reaches,
                  "Bring a joint, given by name or role, to a point at a time: "
                  "RightHand=0.4m,1.2m,0.3m@2s, or for a while: @2s..3.5s; repeatable")
      .one_each_time();
  command
      .add_option("--look-at JOINT=X,Y,Z@TIME", a.looks,
                  "The same for what faces forwards in the reference pose, which then points to "
                  "the place: head=0m,1.5m,4m@1s..3s")
      .one_each_time();
  command
      .add_option("--fade TIME", a.fade,
                  "Time in which --reach and --look-at take hold before, and let go after")
      .default_str("0.5s");
  add_map_option(command, a.map);
}

void declare_planting(CommandOptions& command, Arguments& a) {
  command.group("Feet");
  command.add_flag("--plant", a.plant,
                   "Remove foot skate before the goals are brought about: heel and ball stay where "
                   "they stand, the pelvis is lowered where a leg would be stretched");
  add_contacts_option(command, a.contacts).needs("--plant");
}

void declare_limits(CommandOptions& command, Arguments& a) {
  command.group("Limits");
  command.add_option("--limits IN.json|auto", a.limits,
                     "Ranges of motion: a file (formats/limits/SPEC.md), or auto for published "
                     "ranges of adults by the joints' roles");
  command
      .add_option("--learn-limits IN.anim", a.captures,
                  "Use the ranges that a motion of the same skeleton uses; repeatable")
      .one_each_time();
  command.add_option("--margin ANGLE", a.margin, "Margin added to learnt ranges")
      .default_str("0deg");
  command.add_option("--write-limits OUT.limits.json", a.write_limits,
                     "Write the limits to a file; then neither goals nor -o are needed");
}

void declare_solver(CommandOptions& command, Arguments& a) {
  command.group("Solver");
  add_choice<krok::ik::Method>(command, "--method", a.method,
                               {{"least-squares", krok::ik::Method::least_squares},
                                {"ccd", krok::ik::Method::ccd},
                                {"two-bone", krok::ik::Method::two_bone}},
                               "least-squares: all goals at once; ccd: joint by joint; two-bone: "
                               "the joint's parent and grandparent in closed form",
                               "METHOD", "least-squares");
  command
      .add_option("--stiffness JOINT=NUMBER", a.stiffness,
                  "How much a joint resists, 0 to 1 (does not turn): spine=0.7; repeatable")
      .one_each_time();
  add_whole(command, "--depth", a.depth,
            "How many joints take part for each goal, from the joint's own upwards; 0: all; "
            "default: all below the hips",
            0, 10000);
  command.add_flag("--root-moves", a.root_moves, "The root may be shifted to reach the goals");
  add_whole(command, "--iterations", a.iterations, "Max iterations in a frame", 0, 100'000)
      .default_str("60");
  add_whole(command, "--restarts", a.restarts,
            "Further starts in frames whose goals are not reached; may make a motion jump", 0, 1000)
      .default_str("0");
  command.add_option("--tolerance LENGTH", a.tolerance, "A goal's position is reached within this")
      .default_str("0.01mm");
  command
      .add_option("--angle-tolerance ANGLE", a.angle_tolerance,
                  "A goal's angle is reached within this")
      .default_str("0.01deg");
}

// The text before and after the first `mark`.
bool split(std::string_view text, std::string_view mark, std::string_view& before,
           std::string_view& after) {
  const std::size_t at = text.find(mark);
  if (at == std::string_view::npos) return false;
  before = text.substr(0, at);
  after = text.substr(at + mark.size());
  return true;
}

Result<double> value_of(const char* option, Result<double> parsed) {
  if (parsed) return parsed;
  return usage(fmt::format("{}: {}", option, parsed.error().message), parsed.error().hint);
}

// JOINT=X,Y,Z@TIME or @TIME..TIME.
Result<PointGoal> parse_point(const std::string& option, const std::string& text,
                              krok::ik::Goal::Kind kind) {
  const auto wrong = [&](const std::string& why) {
    return usage(fmt::format("{} {}: {}", option, shown(text), why),
                 "write RightHand=0.4m,1.2m,0.3m@2s or RightHand=0.4m,1.2m,0.3m@2s..3s");
  };
  PointGoal goal;
  goal.option = option;
  goal.kind = kind;
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) return wrong("no joint is named");
  goal.joint = text.substr(0, equals);
  std::string_view place, times;
  if (!split(std::string_view(text).substr(equals + 1), "@", place, times)) {
    return wrong("it has no time");
  }
  for (int i = 0; i < 3; ++i) {
    std::string_view one = place, rest;
    if (i < 2 && !split(place, ",", one, rest)) return wrong("a place has three lengths");
    const auto length = parse_length(one);
    if (!length || !(std::abs(*length) <= 1e6)) {
      return wrong(length ? std::string("the place is farther away than 1000 km")
                          : length.error().message);
    }
    goal.target[i] = *length;
    place = rest;
  }
  std::string_view begin = times, end = times;
  split(times, "..", begin, end);
  const auto from = parse_clip_time(begin), to = parse_clip_time(end);
  if (!from || !to) return wrong((from ? to : from).error().message);
  if (from->in_frames != to->in_frames) return wrong("one time is in frames, the other is not");
  goal.from = from->value;
  goal.to = to->value;
  goal.in_frames = from->in_frames;
  if (!(goal.from >= 0) || goal.to < goal.from) return wrong("it ends before it begins");
  return goal;
}

Result<Stiffness> parse_stiffness(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const auto value = equals == std::string::npos || equals == 0
                         ? std::nullopt
                         : parse_finite(std::string_view(text).substr(equals + 1));
  if (!value || !(*value >= 0 && *value <= 1)) {
    return usage(fmt::format("--stiffness {} is not a joint and a number from 0 to 1", shown(text)),
                 "write spine=0.7");
  }
  return Stiffness{text.substr(0, equals), *value};
}

}  // namespace

void declare(CommandOptions& command, Arguments& arguments) {
  command
      .add_option("input IN.anim", arguments.input,
                  "Motion, or a capture read as by krok-import (- is standard input)")
      .required();
  declare_goals(command, arguments);
  declare_planting(command, arguments);
  declare_limits(command, arguments);
  declare_solver(command, arguments);
  command.group("Output");
  add_orientation_option(command, arguments.orientation);
  command.add_option("--plot OUT.svg", arguments.plot,
                     "Write a chart: by how much each goal is missed over time, which joints' "
                     "limits hold it back, rotations beyond limits before and after");
}

Result<Options> understand(const Arguments& a) {
  Options options;
  options.given = a;
  for (const auto& [list, option, kind] :
       {std::tuple(&a.reaches, "--reach", krok::ik::Goal::Kind::position),
        std::tuple(&a.looks, "--look-at", krok::ik::Goal::Kind::look_at)}) {
    for (const std::string& text : *list) {
      auto goal = parse_point(option, text, kind);
      if (!goal) return goal.error();
      options.points.push_back(*goal);
    }
  }
  for (const std::string& text : a.stiffness) {
    auto stiffness = parse_stiffness(text);
    if (!stiffness) return stiffness.error();
    options.stiffness.push_back(*stiffness);
  }
  const auto fade = parse_clip_time(a.fade);
  if (!fade || fade->in_frames || !(fade->value >= 0)) {
    return usage(fmt::format("--fade {} is not a time of 0 or more seconds", shown(a.fade)));
  }
  options.fade = fade->value;
  const auto margin = value_of("--margin", parse_angle(a.margin));
  if (!margin) return margin.error();
  const auto distance = value_of("--tolerance", parse_length_with_unit(a.tolerance));
  if (!distance) return distance.error();
  const auto angle = value_of("--angle-tolerance", parse_angle(a.angle_tolerance));
  if (!angle) return angle.error();
  if (!(*margin >= 0) || !(*distance > 0) || !(*angle > 0)) {
    return usage("--margin must be 0 or more, --tolerance and --angle-tolerance greater than 0");
  }
  if (!a.limits.empty() && !a.captures.empty()) {
    return usage("--limits and --learn-limits cannot be combined");
  }
  if (!a.write_limits.empty() && a.limits.empty() && a.captures.empty()) {
    return usage("--write-limits has no limits to write", "add --limits auto or --learn-limits");
  }
  if (!options.changes_motion() && a.write_limits.empty()) {
    return usage("no goals are given", "use --goals, --reach, --look-at or --plant");
  }
  if (!options.has_goals() && !a.plot.empty()) {
    return usage("--plot has no goals to show", "use --goals, --reach or --look-at");
  }
  if (!a.plot.empty() && extension(a.plot) != ".svg") {
    return usage(fmt::format("--plot {}: the chart is SVG", shown(a.plot)),
                 "use the extension .svg");
  }
  options.margin = *margin;
  options.solver.method = a.method;
  options.solver.iterations = a.iterations;
  options.solver.restarts = a.restarts;
  options.solver.distance = *distance;
  options.solver.angle = *angle;
  options.solver.root_moves = a.root_moves;
  return options;
}

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec = spec_of("krok-ik", arguments, declare, understand, run);
  spec.summary = "Brings joints of a motion to goals by inverse kinematics";
  spec.details = "Joints stay within their ranges of motion, and feet where they stand.";
  spec.inputs = "IN.anim";
  spec.needs_output = false;  // --write-limits alone is enough
  spec.examples = {
      {"krok-ik walk.anim --reach RightHand=-0.4m,1.1m,0.5m@1s..1.5s -o touch.anim",
       "the hand is at the place from 1 to 1.5 s and moves there and back in half a second each"},
      {"krok-ik walk.anim --goals goals.json --limits auto -o reach.anim -v",
       "goals keyed in time; limits from published ranges of motion"},
      {"krok-ik walk.anim --look-at head=2m,1.5m,3m@0s..2s --stiffness spine=0.9 -o look.anim",
       "the head turns to a place, mostly by the neck"},
      {"krok-ik walk.anim --plant --goals goals.json -o reach.anim --plot reach.svg",
       "feet that stay where they stand, then goals; a chart of what is missed"},
      {"krok-ik walk.anim --learn-limits run.anim --learn-limits dance.anim --write-limits "
       "actor.limits.json",
       "the ranges that an actor uses in captures, as a file for --limits"}};
  spec.batch = {io::motion_endings(), always(".anim")};
  return spec;
}

}  // namespace krok::cli::ik
