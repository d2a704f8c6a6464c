#include "tools/krok-import/options.h"

#include <fmt/format.h>

#include <memory>

#include "formats/io/formats.h"
#include "positions/position_skeleton.h"
#include "tools/cli/option_kinds.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::import {

namespace {

ValueKind<std::optional<Direction>> axis() {
  const auto read = [](const std::string& text) -> Result<Direction> {
    const auto direction = parse_direction(text);
    if (direction) return direction;
    return usage(direction.error().message, "use auto, x, y, z, -x, -y or -z");
  };
  return or_word("auto", ValueKind<Direction>{"axis", "AXIS", read, {}});
}

void declare_inputs(CommandOptions& command, Options& options) {
  command
      .add_option(
          "input IN", options.input,
          "Motion capture (BVH; Acclaim motion, AMC; Acclaim skeleton, ASF; arrays of "
          "numpy, NPY and NPZ) or character "
          "(GLB, glTF, a ZIP with one of them, FBX, COLLADA, SMD, MS3D, 3DS, ASE, MD5); - is "
          "standard input")
      .required();
  command.add_option(
      "--skeleton IN", options.skeleton,
      "Skeleton of an Acclaim motion (IN.asf) [the .asf file beside it whose name starts the "
      "motion's name, or the only one]. What the joints of an array are: " +
          fmt::format("{}", fmt::join(skeleton_names(), ", ")) +
          ", a list (.json), a motion with that skeleton, or for poses of SMPL its model (.npz) "
          "[by the array, or the number of its joints]");
  add_map_option(command, options.map);
  command.add("--save-model OUT.model", options.model, output_of(registry::Kind::model),
              "Write the model: skeleton with reference pose, mesh and skin; for a capture "
              "the skeleton without vertices");
}

void declare_characters(CommandOptions& command, Options& options) {
  command.group("Characters");
  command
      .add("--save-character OUT.character", options.character,
           output_of(registry::Kind::character),
           "Write the whole character: OUT.character and beside it OUT.model, OUT.material, "
           "textures in OUT_textures/, morph targets in OUT_morphs.exr; replaces --save-model and "
           "--save-morphs")
      .not_with({"--save-model", "--save-morphs"});
  command.add_option(
      "--clip NAME", options.clip,
      "Animation to import: name, number from 0, or all; for all, {clip} in the "
      "output's name is the animation's name [the first that moves at least half "
      "as many joints as any other; for --save-cam alone the camera]. For an array of "
      "several motions a number or all [the first]");
  command.add_option("--skin NAME", options.skin,
                     "Use the skeleton of this skin (name or number) if the file has several [the "
                     "one with the most joints]");
  command.add_option("--save-cam OUT.cam", options.cam, "Write a camera of the file");
  command.add_option("--camera NAME", options.camera,
                     "Camera to write: name or number from 0 [the first]");
  command.add_option("--save-morphs OUT.exr", options.morphs,
                     "Write the morph targets as a float texture (OpenEXR), for the vertices that "
                     "--save-model writes");
  command.add_option("--morph-weights OUT.csv", options.weights,
                     "Write the morph target weights over time as a table");
}

void declare_conventions(CommandOptions& command, Options& options) {
  command.group("Conventions of the file");
  command.add("--unit UNIT", options.unit, or_word("auto", length_unit()),
              "Unit of length: auto, m, dm, cm, mm, in, ft, cmu (of the CMU database) or a length "
              "such as 5.64cm",
              "auto");
  command.add("--up AXIS", options.up, axis(), "Up axis: auto, x, y, z, -x, -y, -z", "auto");
  command.add("--forward AXIS", options.forward, axis(),
              "Axis that the character faces in the reference pose: as --up", "auto");
  command
      .add_option("--axes-from IN", options.axes_from,
                  "Axes as this capture has them, so that takes of one skeleton agree where those "
                  "of a take that lies or crawls are in doubt")
      .not_with({"--up", "--forward"});
  command.add(
      "--positions HOW", options.positions,
      choice<bvh::Positions>({{"auto", bvh::Positions::automatic},
                              {"absolute", bvh::Positions::absolute},
                              {"additive", bvh::Positions::additive}}),
      "BVH: whether position channels replace OFFSETs (absolute) or are added to them (additive)",
      "auto");
  command.add(
      "--angles UNIT", options.angles,
      choice<bvh::Angles>({{"degrees", bvh::Angles::degrees}, {"radians", bvh::Angles::radians}}),
      "BVH: unit of rotations: degrees, the format's unit, or radians", "degrees");
}

void declare_timing(CommandOptions& command, Options& options) {
  command.group("Time");
  command.add("--fps", options.fps, rate(), "Frame rate of the file, overrides the file's value");
  command.add("--rate", options.resample, rate(), "Resample the motion to N frames per second");
  command.add(
      "--skip-rest-frame WHEN", options.rest_frame,
      choice<RestFrame>(
          {{"no", RestFrame::keep}, {"auto", RestFrame::automatic}, {"yes", RestFrame::drop}}),
      "Drop the first frame of a capture: auto (if it is a rest pose, not part of the "
      "motion), yes or no",
      "no");
}

void declare_faults(CommandOptions& command, Options& options) {
  command.group("Errors in the file");
  command
      .add_flag(
          "--strict", options.strict,
          "Fail on any error in the file; by default incomplete rows are dropped with a warning")
      .not_with("--repair");
  command.add_flag("--repair", options.repair,
                   "Fill damaged frames from their neighbours; each repair is listed");
}

void declare(CommandOptions& command, Options& options) {
  declare_inputs(command, options);
  declare_characters(command, options);
  declare_conventions(command, options);
  declare_timing(command, options);
  declare_faults(command, options);
  add_orientation_option(command, options.orientation);
}

Status check(const Options& options) {
  if (options.up && options.forward) {
    const auto rotation = rotation_to_krok(*options.up, *options.forward);
    if (!rotation) return usage(rotation.error().message, rotation.error().hint);
  }
  if (options.character != "-") return {};
  return usage("--save-character -: several files cannot go to standard output");
}

}  // namespace

io::CaptureReading read_options(const Options& options) {
  io::CaptureReading result;
  result.unit = options.unit;
  result.up = options.up;
  result.forward = options.forward;
  result.roles = options.roles;
  if (options.fps > 0) result.rate = options.fps;
  result.rest_frame = options.rest_frame;
  result.skeleton = options.skeleton;
  result.positions = options.positions;
  result.angles = options.angles;
  result.strictness = options.strict   ? Strictness::strict
                      : options.repair ? Strictness::repair
                                       : Strictness::normal;
  return result;
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-import", options, declare, check, run);
  spec.summary = "Converts motion captures and characters to Krok's formats";
  spec.details =
      "Captures: BVH, Acclaim, arrays of numpy. Characters: glTF (meshopt and Draco, too), FBX, "
      "COLLADA, SMD, MS3D, "
      "3DS, ASE, MD5.";
  spec.inputs = "IN";
  spec.needs_output = false;  // --save-model or --save-cam alone is enough
  spec.examples = {
      {"krok-import walk.bvh -o walk.anim -v", "detects unit and axes and prints them"},
      {"krok-import take7.bvh -o take7.anim --save-model actor.model --unit in --up z --forward -y",
       "a capture in inches with +Z up, and its skeleton as a model"},
      {"krok-import 01_01.amc --skeleton 01.asf -o walk.anim",
       "an Acclaim motion with its skeleton, as in the CMU database"},
      {"krok-import new_joints/012314.npy --skeleton humanml22 --fps 20 -o walk.anim",
       "joint positions of a generative model, as rotations of a skeleton"},
      {"krok-import amass.npz --skeleton SMPLX_NEUTRAL.npz -o walk.anim",
       "poses of SMPL-X, with the joints of its body"},
      {"krok-import hero.glb --clip Walk -o walk.anim --save-model hero.model --save-cam shot.cam",
       "one animation of a character, its mesh and skin, and the camera"},
      {"krok-import hero.glb --clip all -o 'hero_{clip}.anim' --save-morphs face.exr",
       "all animations, one file each, and the morph targets"},
      {"krok-import hero.glb --save-character hero.character",
       "the whole character: mesh, materials, textures and expressions"},
      {"krok-import broken.bvh -o broken.anim --repair --json",
       "repairs damaged frames and lists the repairs for a script"},
      {"krok-import captures --out-dir motions --keep-going",
       "all captures in a folder; run again, it processes only new, changed and failed files"}};
  // Only files with motion; an Acclaim skeleton or an MD5 mesh is read with the motion beside it.
  spec.batch = {io::foreign_motion_endings(),
                [options]() -> Result<std::string> {
                  return std::string(options->clip == "all" ? "_{clip}.anim" : ".anim");
                },
                // What is not of one animation would be written for each.
                [options] {
                  const Options& o = *options;
                  return o.clip.empty() && o.model.empty() && o.character.empty() &&
                         o.cam.empty() && o.morphs.empty() && o.weights.empty();
                }};
  return spec;
}

}  // namespace krok::cli::import
