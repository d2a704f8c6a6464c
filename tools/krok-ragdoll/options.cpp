#include "tools/krok-ragdoll/options.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"
#include "tools/krok-ragdoll/run.h"
#include "tools/shared/orientation_option.h"
#include "tools/shared/role_input.h"

namespace krok::cli::ragdoll {

namespace {

void declare_fall(CommandOptions& command, Arguments& a) {
  command.group("Fall");
  command.add_option("--at TIME", a.at, "Time at which the body takes over from the motion")
      .default_str("0s");
  command
      .add_option("--push JOINT=X,Y,Z", a.pushes,
                  "Push at a joint, given by name or role: Spine2=120Ns,0,40Ns at --at, or later: "
                  "head=0,0,-30Ns@2s; repeatable")
      .one_each_time();
  command.add_option("--pushes IN.csv", a.push_table,
                     "A fall for each row of a table with the columns name, at, joint, x, y, z and "
                     "maybe time; {name} in the output's name is the row's");
  command
      .add_option("--get-up IN.anim", a.rises,
                  "Get up once at rest, with the motion whose first pose, or its mirror image, is "
                  "nearest; repeatable")
      .one_each_time();
  command
      .add_option("--duration TIME", a.duration,
                  "Length of the fall; where the motion plays on, to its end")
      .default_str("3s");
}

void declare_body(CommandOptions& command, Arguments& a) {
  command.group("Body");
  command.add_option("--model IN.model", a.model,
                     "Fit the bodies to this model's vertices by their weights");
  command.add_option(
      "--bodies IN.ragdoll.json", a.bodies,
      "Bodies and joints from a file (formats/ragdoll/SPEC.md) instead of made ones");
  command.add_option(
      "--save-bodies OUT.ragdoll.json|OUT.glb", a.save_bodies,
      "Also save the bodies and joints: to be edited and given to --bodies, or as meshes (.glb)");
  command.add_option("--mass MASS", a.mass, "Mass of the body").default_str("75kg");
  command
      .add_option("--limits IN.json|auto|none", a.limits,
                  "Ranges of motion: a file (formats/limits/SPEC.md), auto for published ranges of "
                  "adults, or none")
      .default_str("auto");
  command.add_flag("--soft", a.soft, "Limits push back as springs instead of stopping");
  add_map_option(command, a.map);
}

void declare_surroundings(CommandOptions& command, Arguments& a) {
  command.group("Surroundings");
  command
      .add_option("--ground IN|KIND", a.ground,
                  "Ground: level[:height=H], stairs, slope:ANGLE, rough, or a file (glTF, GLB, "
                  "OBJ, EXR, PNG)")
      .default_str("level");
  add_number(command, "--friction", a.friction, "Coefficient of friction, 0 to 10")
      .default_str("0.7");
  add_number(command, "--restitution", a.restitution, "Share of speed kept in a bounce, 0 to 1")
      .default_str("0");
}

// A number with an optional unit.
std::optional<double> number_of(std::string_view text, std::string_view unit) {
  if (text.ends_with(unit)) text.remove_suffix(unit.size());
  return parse_finite(text);
}

Result<PushAt> parse_push(const std::string& text) {
  const auto wrong = [&](const std::string& why) {
    return usage(fmt::format("--push {}: {}", shown(text), why),
                 "write Spine2=120Ns,0,40Ns or Spine2=120Ns,0,40Ns@2s");
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
  for (int i = 0; i < 3; ++i) {
    const std::size_t comma = impulse.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return wrong("an impulse has three parts");
    const auto value = number_of(impulse.substr(0, comma), "Ns");
    if (!value || !(std::abs(*value) <= kMaxImpulse)) {
      return wrong("an impulse is a number of Ns, up to 10000");
    }
    push.impulse[i] = *value;
    if (i < 2) impulse.remove_prefix(comma + 1);
  }
  return push;
}

Status understand_playing_on(const Arguments& a, Options& options) {
  auto follow = understand_follow(a.follow);
  if (!follow) return follow.error();
  options.follow = std::move(*follow);
  if (options.follow.until && options.duration) {
    return usage("--duration and --until exclude each other");
  }
  if (options.follow.any() && !a.rises.empty()) {
    return usage("--get-up needs a fall that comes to rest",
                 "leave out --powered, --hold and --simulated");
  }
  return {};
}

}  // namespace

void declare(CommandOptions& command, Arguments& arguments) {
  command
      .add_option("input IN.anim", arguments.input,
                  "Motion, or a capture read as by krok-import (- is standard input)")
      .required();
  declare_fall(command, arguments);
  declare_follow(command, arguments.follow);
  declare_body(command, arguments);
  declare_surroundings(command, arguments);
  add_orientation_option(command, arguments.orientation);
}

Result<Options> understand(const Arguments& a) {
  Options options;
  options.given = a;
  for (const std::string& text : a.pushes) {
    auto push = parse_push(text);
    if (!push) return push.error();
    options.pushes.push_back(*push);
  }
  if (!(a.friction >= 0 && a.friction <= 10) || !(a.restitution >= 0 && a.restitution <= 1)) {
    return usage("--friction must be from 0 to 10, --restitution from 0 to 1");
  }
  if (!a.bodies.empty()) {
    const std::pair<const char*, bool> unused[] = {{"--model", !a.model.empty()},
                                                   {"--mass", a.mass != Arguments().mass},
                                                   {"--limits", a.limits != Arguments().limits},
                                                   {"--soft", a.soft}};
    for (const auto& [option, given] : unused) {
      if (given) {
        return usage(fmt::format("--bodies has what {} would change", option),
                     "edit the file, or leave one of them out");
      }
    }
  }
  if (!a.push_table.empty()) {
    const std::pair<const char*, bool> unused[] = {{"--at", a.at != Arguments().at},
                                                   {"--push", !a.pushes.empty()},
                                                   {"--save-bodies", !a.save_bodies.empty()}};
    for (const auto& [option, given] : unused) {
      if (given) return usage(fmt::format("--pushes and {} exclude each other", option));
    }
  }
  const std::string ending = extension(a.save_bodies);
  if (!a.save_bodies.empty() && ending != ".json" && ending != ".glb") {
    return usage(
        fmt::format("--save-bodies: '{}' is neither .ragdoll.json nor .glb", shown(a.save_bodies)));
  }
  const auto begin = parse_clip_time(a.at);
  if (!begin || !(begin->value >= 0)) {
    return usage(fmt::format("--at {} is not a time of 0 or more", shown(a.at)));
  }
  options.at = *begin;
  if (!a.duration.empty()) {
    const auto duration = parse_clip_time(a.duration);
    if (!duration || duration->in_frames || !(duration->value > 0 && duration->value <= 600)) {
      return usage(fmt::format("--duration {} is not a time of up to 600 s", shown(a.duration)));
    }
    options.duration = duration->value;
  }
  if (Status status = understand_playing_on(a, options); !status) return status.error();
  const auto mass = number_of(a.mass, "kg");
  if (!mass || !(*mass >= 1 && *mass <= 1000)) {
    return usage(fmt::format("--mass {} is not a mass from 1 to 1000 kg", shown(a.mass)));
  }
  options.mass = *mass;
  return options;
}

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec = spec_of("krok-ragdoll", arguments, declare, understand, run);
  spec.summary = "Lets a motion's character fall by physics";
  spec.details = "Rigid bodies with joints take over from the motion.";
  spec.inputs = "IN.anim";
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
  spec.batch = {io::motion_endings(), [arguments]() -> Result<std::string> {
                  return std::string(arguments->push_table.empty() ? ".anim" : "_{name}.anim");
                }};
  return spec;
}

}  // namespace krok::cli::ragdoll
