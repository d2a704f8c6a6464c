#include "tools/krok-ragdoll/options.h"

#include <fmt/format.h>

#include <string_view>

#include "core/text.h"
#include "formats/io/formats.h"

namespace krok::cli::ragdoll {

namespace {

Result<PushAt> parse_push(const std::string& text) {
  const auto wrong = [&](const std::string& why) {
    return usage(
        fmt::format("'{}': {}", shown(text), why),
        "write Spine2=120Ns,0,40Ns or Spine2=120Ns,0,40Ns@2s; --push-every 2s pushes again "
        "and again");
  };
  PushAt push;
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) return wrong("no joint is named");
  push.joint = text.substr(0, equals);
  std::string_view impulse = std::string_view(text).substr(equals + 1);
  if (const std::size_t mark = impulse.find('@'); mark != std::string_view::npos) {
    const auto time = parse_clip_time(impulse.substr(mark + 1));
    if (!time || !(time->value >= 0)) return wrong("its time is not one of 0 or more");
    push.timed = true;
    push.time = *time;
    impulse = impulse.substr(0, mark);
  }
  const ValueKind<double> part = number({-kMaxImpulse, kMaxImpulse}, "Ns");
  const auto parts = numbers_as<Vec3>({part, part, part}, 3).read(std::string(impulse));
  if (!parts) return wrong("an impulse has three parts; " + parts.error().message);
  push.impulse = *parts;
  return push;
}

void declare_fall(CommandOptions& command, Options& o) {
  command.group("Fall");
  command.add("--at", o.at, clip_time(), "Time at which the body takes over from the motion", "0s")
      .not_with("--pushes");
  command
      .add("--push", o.pushes, ValueKind<PushAt>{"push", "JOINT=X,Y,Z", parse_push, {}},
           "Push at a joint, given by name or role: Spine2=120Ns,0,40Ns at --at, or later: "
           "head=0,0,-30Ns@2s; repeatable")
      .not_with("--pushes");
  command.add_option("--pushes IN.csv", o.push_table,
                     "A fall for each row of a table with the columns name, at, joint, x, y, z and "
                     "maybe time; {name} in the output's name is the row's");
  command
      .add_option("--get-up IN.anim", o.rises,
                  "Get up once at rest, with the motion whose first pose, or its mirror image, is "
                  "nearest; repeatable")
      .one_each_time()
      .not_with({"--powered", "--hold", "--simulated"});
  command
      .add("--duration", o.duration, seconds({0, 600, true}),
           "Length of the fall; where the motion plays on, to its end", "3s")
      .not_with("--until");
}

void declare_body(CommandOptions& command, Options& o) {
  command.group("Body");
  command
      .add_option("--model IN.model", o.model,
                  "Fit the bodies to this model's vertices by their weights")
      .not_with("--bodies");
  command.add_option(
      "--bodies IN.ragdoll.json", o.bodies,
      "Bodies and joints from a file (formats/ragdoll/SPEC.md) instead of made ones");
  command
      .add("--save-bodies OUT.ragdoll.json|OUT.glb", o.save_bodies, output({".json", ".glb"}),
           "Also save the bodies and joints: to be edited and given to --bodies, or as meshes "
           "(.glb)")
      .not_with("--pushes");
  command
      .add("--mass MASS", o.mass, number({0.001, 100000}, "kg"),
           "Mass of the whole body [75kg; of what is no humanoid its volume at 1000 kg/m3]")
      .not_with("--bodies");
  command
      .add_option("--limits IN.json|auto|none", o.limits,
                  "Ranges of motion: a file (formats/limits/SPEC.md), auto for published ranges of "
                  "adults (of what is no humanoid 50 degrees to all sides), or none")
      .default_str("auto")
      .not_with("--bodies");
  command.add_flag("--soft", o.soft, "Limits push back as springs instead of stopping")
      .not_with("--bodies");
  add_map_option(command, o.map);
}

void declare_surroundings(CommandOptions& command, Options& o) {
  command.group("Surroundings");
  add_ground_option(command, o.ground,
                    "Ground: level[:height=H], stairs, slope:ANGLE, rough, or a file (glTF, GLB, "
                    "OBJ, EXR, PNG)",
                    "level")
      .type_name("IN|KIND");
  command.add("--friction", o.friction, number({0, 10}), "Coefficient of friction, 0 to 10", "0.7");
  command.add("--restitution", o.restitution, number({0, 1}),
              "Share of speed kept in a bounce, 0 to 1", "0");
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option("input IN.anim", o.input,
                  "Motion, or a capture read as by krok-import (- is standard input)")
      .required();
  declare_fall(command, o);
  declare_follow(command, o.follow);
  declare_body(command, o);
  declare_surroundings(command, o);
  add_orientation_option(command, o.orientation);
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-ragdoll", options, declare, nullptr, run);
  spec.summary = "Lets a motion's character fall by physics";
  spec.details = "Rigid bodies with joints take over from the motion.";
  spec.inputs = "IN.anim";
  spec.writes = registry::Kind::anim;
  spec.examples = {
      {"krok-ragdoll walk.anim --at 1.2s --push Spine2=120Ns,0,40Ns -o fall.anim",
       "a walker is shoved from the side and falls"},
      {"krok-ragdoll walk.anim --powered 0.6 --push-every 2s -o shoved.anim",
       "a walker is pushed every two seconds, staggers, and goes on walking"},
      {"krok-ragdoll walk.anim --simulated left_upper_arm -o limp.anim",
       "an arm hangs limp while all else stays the motion's"},
      {"krok-ragdoll walk.anim --model walker.model --at 2s --ground stairs.glb --duration 5s -o "
       "fall.anim --json",
       "bodies in the sizes of a character, on a mesh; the report has the measures"},
      {"krok-ragdoll walk.anim --pushes pushes.csv -o 'falls/{name}.anim' --json",
       "a fall for each row of a table"},
      {"krok-ragdoll walk.anim --at 1s --push Spine2=90Ns,0,0 --get-up front.anim --get-up "
       "back.anim "
       "-o up.anim",
       "falls and gets up, over the front or the back as it lies"}};
  spec.exit_partly = "with --pushes: some rows failed, all others were written";
  spec.batch = {io::motion_endings(), [options]() -> Result<std::string> {
                  return std::string(options->push_table.empty() ? ".anim" : "_{name}.anim");
                }};
  return spec;
}

}  // namespace krok::cli::ragdoll
