#include "tools/krok-ik/options.h"

#include <fmt/format.h>

#include <string_view>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/chart/chart_writer.h"
#include "formats/io/formats.h"

namespace krok::cli::ik {

namespace {

// The text before and after the first `mark`.
bool split(std::string_view text, std::string_view mark, std::string_view& before,
           std::string_view& after) {
  const std::size_t at = text.find(mark);
  if (at == std::string_view::npos) return false;
  before = text.substr(0, at);
  after = text.substr(at + mark.size());
  return true;
}

// JOINT=X,Y,Z@TIME or @TIME..TIME.
Result<PointGoal> parse_point(const std::string& option, krok::ik::Goal::Kind kind,
                              const std::string& text) {
  const auto wrong = [&](const std::string& why) {
    return usage(fmt::format("'{}': {}", shown(text), why),
                 kind == krok::ik::Goal::Kind::look_at
                     ? "write head=0m,1.5m,4m@1s..3s, or eyes=... for the eyes"
                     : "write RightHand=0.4m,1.2m,0.3m@2s or RightHand=0.4m,1.2m,0.3m@2s..3s");
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
  const auto target = lengths<Vec3>().read(std::string(place));
  if (!target) {
    Error error = wrong("a place has three lengths: " + target.error().message);
    if (target.error().code == "quantity-no-unit") error.hint = target.error().hint;
    return error;
  }
  if (!(target->cwiseAbs().maxCoeff() <= 1e6)) return wrong("it is farther away than 1000 km");
  goal.target = *target;
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

ValueKind<PointGoal> point_goal(const std::string& option, krok::ik::Goal::Kind kind) {
  return {"goal",
          "JOINT=X,Y,Z@TIME",
          [=](const std::string& text) { return parse_point(option, kind, text); },
          {}};
}

Result<Stiffness> parse_stiffness(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const auto value = equals == std::string::npos || equals == 0
                         ? std::nullopt
                         : parse_finite(std::string_view(text).substr(equals + 1));
  if (!value || !(*value >= 0 && *value <= 1)) {
    return usage(fmt::format("'{}' is not a joint and a number from 0 to 1", shown(text)),
                 "write spine=0.7");
  }
  return Stiffness{text.substr(0, equals), *value};
}

void declare_goals(CommandOptions& command, Options& o) {
  command.group("Goals");
  command.add_option("--goals IN.json", o.goals, "Goals (.json, formats/goals/SPEC.md)");
  add_ground_option(command, o.ground,
                    "Heights of goals in the world are over this ground, as for krok-walk: a mesh, "
                    "a height field, stairs:rise=17cm,run=29cm, slope:12deg, ...");
  command.add("--reach", o.points, point_goal("--reach", krok::ik::Goal::Kind::position),
              "Bring a joint, given by name or role, to a point of the world at a time: "
              "RightHand=0.4m,1.2m,0.3m@2s, or for a while: @2s..3.5s (x to the left of who faces "
              "+Z, y up; --goals for points in a joint's frame); repeatable");
  command.add("--look-at", o.looks, point_goal("--look-at", krok::ik::Goal::Kind::look_at),
              "The same for what faces forwards in the reference pose, which then points to the "
              "place: head=0m,1.5m,4m@1s..3s. eyes=...: the eyes jump there at the first time, "
              "and the head follows with its share; eyes without a joint become joints");
  command.add_option("--character IN.character", o.character,
                     "Character whose sockets may be named instead of joints, and whose eyes turn");
  command.add("--fade", o.fade, seconds(),
              "Time in which --reach and --look-at take hold before, and let go after", "0.5s");
  add_map_option(command, o.map);
}

void declare_planting(CommandOptions& command, Options& o) {
  command.group("Feet");
  command.add_flag("--plant", o.plant,
                   "Remove foot skate before the goals are brought about: heel and ball stay where "
                   "they stand, the pelvis is lowered where a leg would be stretched");
  add_contacts_option(command, o.contacts).only_with("--plant");
}

void declare_limits(CommandOptions& command, Options& o) {
  command.group("Limits");
  command
      .add_option("--limits IN.json|auto", o.limits,
                  "Ranges of motion: a file (formats/limits/SPEC.md), or auto for published ranges "
                  "of adults by the joints' roles")
      .not_with("--learn-limits");
  command
      .add_option("--learn-limits IN.anim", o.captures,
                  "Use the ranges that a motion of the same skeleton uses; repeatable")
      .one_each_time();
  command.add("--limit-margin", o.margin, angle(kNotNegative), "Margin added to learnt ranges",
              "0deg");
  command
      .add("--save-limits OUT.limits.json", o.write_limits, output({".json"}),
           "Write the limits to a file; then neither goals nor -o are needed")
      .only_with({"--limits", "--learn-limits"});
}

void declare_solver(CommandOptions& command, Options& o) {
  command.group("Solver");
  command.add("--solver METHOD", o.solver.method,
              choice<krok::ik::Method>({{"least-squares", krok::ik::Method::least_squares},
                                        {"sdls", krok::ik::Method::selectively_damped},
                                        {"ccd", krok::ik::Method::ccd},
                                        {"two-bone", krok::ik::Method::two_bone}}),
              "least-squares: all goals at once; sdls: the same, damped selectively, for goals in "
              "and out of reach; ccd: joint by joint; two-bone: the joint's parent "
              "and grandparent in closed form",
              "least-squares");
  command.add("--stiffness", o.stiffness,
              ValueKind<Stiffness>{"stiffness", "JOINT=NUMBER", parse_stiffness, {}},
              "How much a joint resists, 0 to 1 (does not turn): spine=0.7; repeatable");
  command.add(
      "--whole-body", o.whole_body, number({0, 1}),
      "How much spine, chest and collar bones of a humanoid take part: 0.5 by the mass that "
      "they carry, so that arms reach first; 1 as any other joint; 0 where nothing else "
      "reaches. The head keeps its direction",
      "0.5");
  command.add("--depth", o.depth, whole(0, 10000),
              "How many joints take part for each goal, from the joint's own upwards; 0: all; "
              "default: all below the hips");
  command.add_flag("--root-moves", o.solver.root_moves,
                   "The root may be shifted to reach the goals, or the pelvis over a root on the "
                   "ground");
  command.add("--iterations", o.solver.iterations, whole(0, 100'000), "Max iterations in a frame",
              "60");
  command.add("--restarts", o.solver.restarts, whole(0, 1000),
              "Further starts in frames whose goals are not reached; may make a motion jump", "0");
  command.add("--tolerance", o.solver.distance, length_with_unit(kPositive),
              "A goal's position is reached within this", "0.01mm");
  command.add("--angle-tolerance", o.solver.angle, angle(kPositive),
              "A goal's angle is reached within this", "0.01deg");
  command.add_flag("--strict", o.strict, "Exit with 1 if a goal is missed (otherwise a warning)");
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option("input IN.anim", o.input,
                  "Motion, or a capture read as by krok-import (- is standard input)")
      .required();
  declare_goals(command, o);
  declare_planting(command, o);
  declare_limits(command, o);
  declare_solver(command, o);
  command.group("Output");
  add_orientation_option(command, o.orientation);
  command
      .add("--plot OUT.svg", o.plot, output(chart::endings()),
           "Write a chart (SVG, PDF, PNG): by how much each goal is missed over time, which "
           "joints' limits hold it "
           "back, rotations beyond limits before and after")
      .only_with({"--goals", "--reach", "--look-at"});
}

Status check(const Options& o) {
  if (o.changes_motion() || !o.write_limits.empty()) return {};
  return usage("no goals are given", "use --goals, --reach, --look-at or --plant");
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-ik", options, declare, check, run);
  spec.summary = "Brings joints of a motion to goals by inverse kinematics";
  spec.details =
      "Feet stay where they stand, and with --limits joints within their ranges of motion.";
  spec.inputs = "IN.anim";
  spec.writes = registry::Kind::anim;
  spec.needs_output = false;  // --save-limits alone is enough
  spec.examples = {
      {"krok-ik walk.anim --reach RightHand=-0.4m,1.1m,0.5m@1s..1.5s -o touch.anim",
       "the hand is at the place from 1 to 1.5 s and moves there and back in half a second each"},
      {"krok-ik walk.anim --goals goals.json --limits auto -o reach.anim -v",
       "goals keyed in time; limits from published ranges of motion"},
      {"krok-ik walk.anim --look-at head=2m,1.5m,3m@0s..2s --stiffness spine=0.9 -o look.anim",
       "the head turns to a place, mostly by the neck"},
      {"krok-ik walk.anim --character hero.character --look-at eyes=2m,1.6m,3m@1s..2s -o look.anim",
       "the eyes jump to a place and the head follows"},
      {"krok-ik walk.anim --plant --goals goals.json -o reach.anim --plot reach.svg",
       "feet that stay where they stand, then goals; a chart of what is missed"},
      {"krok-ik walk.anim --learn-limits run.anim --learn-limits dance.anim --save-limits "
       "actor.limits.json",
       "the ranges that an actor uses in captures, as a file for --limits"}};
  spec.exit_no = "with --strict: a goal is missed";
  spec.batch = {io::motion_endings(), always(".anim")};
  return spec;
}

}  // namespace krok::cli::ik
