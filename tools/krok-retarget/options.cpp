#include "tools/krok-retarget/options.h"

#include <fmt/format.h>

#include <memory>

#include "core/numbers.h"
#include "formats/io/formats.h"
#include "terrain/spec.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-retarget/run.h"
#include "tools/shared/ground_option.h"
#include "tools/shared/orientation_option.h"
#include "tools/shared/planting.h"
#include "tools/shared/role_input.h"

namespace krok::cli::retarget {

namespace {

std::optional<int> frame_number(const std::string& text) {
  const auto frame = parse_integer(text);
  if (!frame || *frame < 0 || *frame > 2'000'000'000) return std::nullopt;
  return static_cast<int>(*frame);
}

Result<std::optional<int>> parse_frame(const char* option, const std::string& text) {
  if (text == "auto" || pose_of_file(text)) return std::optional<int>();
  const auto frame = frame_number(text);
  if (!frame) {
    return Error("usage",
                 fmt::format("{} {} is not auto, a frame number or FILE:FRAME", option, text),
                 "frames are numbered from 0");
  }
  return frame;
}

}  // namespace

std::optional<PoseOfFile> pose_of_file(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  const auto frame = frame_number(text.substr(colon + 1));
  if (!frame) return std::nullopt;
  return PoseOfFile{text.substr(0, colon), *frame};
}

Result<krok::retarget::Options> parse(const Options& options) {
  krok::retarget::Options parsed;
  parsed.feet = options.feet;
  if (!options.scale.empty()) {
    const auto scale = parse_finite(options.scale);
    if (!scale || !(*scale > 0)) {
      return Error("usage",
                   fmt::format("--scale {} is not a number greater than 0", options.scale));
    }
    parsed.scale = *scale;
  }
  const auto source_frame = parse_frame("--reference-pose", options.reference_pose);
  if (!source_frame) return source_frame.error();
  const auto target_frame = parse_frame("--onto-reference-pose", options.onto_reference_pose);
  if (!target_frame) return target_frame.error();
  parsed.source_frame = *source_frame;
  parsed.target_frame = *target_frame;
  return parsed;
}

namespace {

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("input IN.anim", options.input,
                  "Motion, or a capture read as by krok-import (- is standard input)")
      .required();
  command
      .add_option("--onto IN.model|IN.character|IN.anim", options.onto,
                  "Target skeleton: a model or character, or any motion or capture of it")
      .required();
  command.group("Joints");
  add_map_option(command, options.map, "--map",
                 "Role map (JSON) for input joints whose names do not identify them");
  add_map_option(command, options.onto_map, "--onto-map", "The same for the target's joints");
  const CommandOption pose = command.add_option(
      "--reference-pose POSE", options.reference_pose,
      "Pose of the input that matches the target's reference pose: a frame number, a "
      "frame of another motion of its skeleton (tpose.anim:0), or auto: its own "
      "reference pose or, if that is not a standing pose, a T-pose built "
      "from the skeleton");
  pose.default_str("auto");
  const CommandOption onto_pose =
      command.add_option("--onto-reference-pose POSE", options.onto_reference_pose,
                         "The same for a target that is a motion");
  onto_pose.default_str("auto");
  const CommandOption takes =
      command.add_option("--takes IN", options.takes,
                         "Build that T-pose from these takes of the input's actor, too: a file, a "
                         "folder or a pattern; repeatable");
  takes.one_each_time().excludes(pose);
  command
      .add_option("--alignment IN.json", options.alignment,
                  "Poses of both skeletons that match, as --save-alignment wrote them, so that all "
                  "motions of a pair are retargeted alike")
      .excludes(pose)
      .excludes(onto_pose)
      .excludes(takes);
  command.add_option("--save-alignment OUT.json", options.save_alignment,
                     "Write the poses that were matched; without -o nothing else is written");
  command.group("Motion");
  add_choice<krok::retarget::Feet>(
      command, "--feet", options.feet,
      {{"keep", krok::retarget::Feet::keep}, {"free", krok::retarget::Feet::free}},
      "keep: foot positions follow the input's, scaled, and stay above the floor; free: from the "
      "leg rotations only",
      "HOW", "keep");
  command.add_option("--scale NUMBER", options.scale,
                     "Scale of the root motion; default: ratio of leg lengths");
  command.group("Ground");
  command.add_option("--ground IN", options.ground,
                     "Ground that the motion was made for, as for krok-walk: the target walks on "
                     "it, too, with its feet where the input's stand. A height field (.exr, 16-bit "
                     ".png), a mesh (.gltf, .glb, .obj), or " +
                         std::string(terrain::kSpecForms));
  add_contacts_option(command, options.contacts);
  add_orientation_option(command, options.orientation);
}

Status check(const Options& options) {
  if (options.ground.empty() && options.contacts != "auto") {
    return Error("usage", "--contacts is for --ground");
  }
  if (!options.ground.empty() && options.feet == krok::retarget::Feet::free) {
    return Error("usage", "--ground keeps the feet, --feet free does not");
  }
  if (Status status = check_ground_text(options.ground); !status) return status;
  const auto how = parse(options);
  return how ? Status() : how.error();
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-retarget", options, declare, check, run);
  spec.summary = "Retargets a motion to another skeleton";
  spec.details = "Feet stay where they stand, on any ground.";
  spec.inputs = "--onto IN.model|IN.character|IN.anim IN.anim";
  spec.needs_output = false;  // --save-alignment alone is enough
  spec.examples = {{"krok-retarget --onto hero.model walk.anim -o hero_walk.anim -v",
                    "joints are mapped by role; -v prints the mapping"},
                   {"krok-retarget --map rig.json --onto hero.model take.anim -o hero_take.anim",
                    "rig.json gives the roles of unusual joint names: {\"joints\": {\"Bone_012\": "
                    "\"left_hand\"}}"},
                   {"krok-retarget --onto child.model walk.anim --ground stairs:rise=17cm,run=29cm "
                    "-o child_walk.anim",
                    "a walk of krok-walk on another skeleton, on the same stairs"},
                   {"krok-retarget --onto hero.model takes/walk.bvh --takes takes --save-alignment "
                    "pair.json && krok-retarget --onto hero.model takes --alignment pair.json "
                    "--out-dir hero_takes",
                    "all takes of an actor, aligned by what all of them show"},
                   {"krok-retarget --onto hero.model motions --out-dir hero_motions",
                    "all motions in a folder"}};
  spec.batch = {io::motion_endings(), always(".anim")};
  return spec;
}

}  // namespace krok::cli::retarget
