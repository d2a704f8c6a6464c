#include "tools/krok-retarget/options.h"

#include <fmt/format.h>

#include <memory>

#include "core/text.h"
#include "formats/io/formats.h"
#include "terrain/spec.h"

namespace krok::cli::retarget {

namespace {

Result<MatchingPose> parse_pose(const std::string& text) {
  if (text == "auto") return MatchingPose{};
  const std::size_t colon = text.rfind(':');
  const bool of_file = colon != std::string::npos && colon > 0;
  const auto frame = whole(0, 2'000'000'000).read(of_file ? text.substr(colon + 1) : text);
  if (frame) return MatchingPose{of_file ? text.substr(0, colon) : "", static_cast<int>(*frame)};
  return usage(fmt::format("'{}' is not auto, a frame number or FILE:FRAME", shown(text)),
               "leave it out: auto finds the T-pose; a number is the frame, from 0, that shows it");
}

void declare(CommandOptions& command, Options& o) {
  const ValueKind<MatchingPose> pose{"pose", "POSE", parse_pose, {}};
  command
      .add_option("input IN.anim", o.input,
                  "Motion, or a capture read as by krok-import (- is standard input)")
      .required();
  command
      .add_option("--onto IN.model|IN.character|IN.anim", o.onto,
                  "Target skeleton: a model or character, or any motion or capture of it")
      .required();
  command.group("Joints");
  command.add_option("--map IN.json", o.map,
                     "Role map (JSON) for input joints whose names do not identify them");
  command.add_option("--onto-map IN.json", o.onto_map, "The same for the target's joints");
  command.add("--reference-pose", o.reference_pose, pose,
              "Pose of the input that matches the target's reference pose: a frame number, a frame "
              "of another motion of its skeleton (tpose.anim:0), or auto: its own reference pose "
              "or, if that is not a standing pose, a T-pose built from the skeleton",
              "auto");
  command.add("--onto-reference-pose", o.onto_reference_pose, pose,
              "The same for a target that is a motion", "auto");
  command
      .add_option("--takes IN", o.takes,
                  "Build that T-pose from these takes of the input's actor, too: a file, a folder "
                  "or a pattern; repeatable")
      .one_each_time()
      .not_with("--reference-pose");
  command
      .add_option("--alignment IN.json", o.alignment,
                  "Poses of both skeletons that match, as --save-alignment wrote them, so that all "
                  "motions of a pair are retargeted alike")
      .not_with({"--reference-pose", "--onto-reference-pose", "--takes"});
  command.add("--save-alignment OUT.json", o.save_alignment, output({".json"}),
              "Write the poses that were matched; without -o nothing else is written");
  command.group("Motion");
  command.add("--feet HOW", o.feet,
              choice<krok::retarget::Feet>(
                  {{"keep", krok::retarget::Feet::keep}, {"free", krok::retarget::Feet::free}}),
              "keep: foot positions follow the input's, scaled, and stay above the floor; free: "
              "from the leg rotations only",
              "keep");
  command.add("--touches HOW", o.touches,
              choice<krok::retarget::Touches>({{"keep", krok::retarget::Touches::keep},
                                               {"free", krok::retarget::Touches::free}}),
              "keep: hands, elbows, knees and seat touch the ground where the input's do (with "
              "--feet keep, without --ground), and hands each other and the body; free: as the "
              "rotations place them",
              "keep");
  command.add("--scale NUMBER", o.scale, number(kPositive),
              "Scale of the root motion; default: ratio of leg lengths");
  command.group("Ground");
  add_ground_option(command, o.ground,
                    "Ground that the motion was made for, as for krok-walk: the target walks on "
                    "it, too, with its feet where the input's stand. A height field (.exr, 16-bit "
                    ".png), a mesh (.gltf, .glb, .obj), or " +
                        std::string(terrain::kSpecForms))
      .not_with("--feet free");
  add_contacts_option(command, o.contacts).only_with("--ground");
  add_orientation_option(command, o.orientation);
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-retarget", options, declare, nullptr, run);
  spec.summary = "Retargets a motion to another skeleton";
  spec.details = "Feet stay where they stand, on any ground.";
  spec.inputs = "--onto IN.model|IN.character|IN.anim IN.anim";
  spec.writes = registry::Kind::anim;
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
