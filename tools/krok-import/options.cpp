#include "tools/krok-import/options.h"

#include <fmt/format.h>

#include <memory>

#include "formats/io/formats.h"
#include "formats/registry/registry.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_kind.h"
#include "tools/krok-import/run.h"
#include "tools/shared/orientation_option.h"

namespace krok::cli::import {

namespace {

Result<std::optional<Direction>> direction_option(const std::string& text, const char* option) {
  if (text == "auto") return std::optional<Direction>();
  const auto direction = parse_direction(text);
  if (!direction) {
    return Error("usage", fmt::format("{}: {}", option, direction.error().message),
                 "use auto, x, y, z, -x, -y or -z");
  }
  return std::optional<Direction>(*direction);
}

void declare_inputs(CommandOptions& command, Options& options) {
  command
      .add_option(
          "input IN", options.input,
          "Motion capture (BVH; Acclaim motion, AMC; Acclaim skeleton, ASF) or character "
          "(GLB, glTF, a ZIP with one of them, FBX, COLLADA, SMD, MS3D, 3DS, ASE, MD5); - is "
          "standard input")
      .required();
  command.add_option("--skeleton IN.asf", options.skeleton,
                     "Skeleton of an Acclaim motion; default: the .asf file beside it whose name "
                     "starts the motion's name, or the only one");
  add_map_option(command, options.map);
  command.add_option("--model OUT.model", options.model,
                     "Write the model: skeleton with reference pose, mesh and skin; for a capture "
                     "the skeleton without vertices");
}

void declare_characters(CommandOptions& command, Options& options) {
  command.group("Characters");
  command.add_option(
      "--character OUT.character", options.character,
      "Write the whole character: OUT.character and beside it OUT.model, OUT.material, textures in "
      "OUT_textures/, morph targets in OUT_morphs.exr; replaces --model and --morphs");
  command.add_option("--clip NAME", options.clip,
                     "Animation to import: name, number from 0, or all; for all, {clip} in the "
                     "output's name is the animation's name [the first that moves at least half "
                     "as many joints as any other; for --cam alone the camera]");
  command.add_option("--skin NAME", options.skin,
                     "Use the skeleton of this skin (name or number) if the file has several [the "
                     "one with the most joints]");
  command.add_option("--cam OUT.cam", options.cam, "Write a camera of the file");
  command.add_option("--camera NAME", options.camera,
                     "Camera to write: name or number from 0 [the first]");
  command.add_option(
      "--morphs OUT.exr", options.morphs,
      "Write the morph targets as a float texture (OpenEXR), for the vertices that --model writes");
  command.add_option("--morph-weights OUT.csv", options.weights,
                     "Write the morph target weights over time as a table");
}

void declare_conventions(CommandOptions& command, Options& options) {
  command.group("Conventions of the file");
  command
      .add_option("--unit UNIT", options.unit,
                  "Unit of length: auto, m, dm, cm, mm, in, ft, cmu (of the CMU database) or a "
                  "length such as 5.64cm")
      .default_str("auto");
  const CommandOption up =
      command.add_option("--up AXIS", options.up, "Up axis: auto, x, y, z, -x, -y, -z");
  up.default_str("auto");
  const CommandOption forward =
      command.add_option("--forward AXIS", options.forward,
                         "Axis that the character faces in the reference pose: as --up");
  forward.default_str("auto");
  command
      .add_option("--axes-from IN", options.axes_from,
                  "Axes as this capture has them, so that takes of one skeleton agree where those "
                  "of a take that lies or crawls are in doubt")
      .excludes(up)
      .excludes(forward);
  add_choice<bvh::Positions>(
      command, "--positions", options.positions,
      {{"auto", bvh::Positions::automatic},
       {"absolute", bvh::Positions::absolute},
       {"additive", bvh::Positions::additive}},
      "BVH: whether position channels replace OFFSETs (absolute) or are added to them (additive)",
      "HOW", "auto");
  add_choice<bvh::Angles>(command, "--angles", options.angles,
                          {{"degrees", bvh::Angles::degrees}, {"radians", bvh::Angles::radians}},
                          "BVH: unit of rotations: degrees, the format's unit, or radians", "UNIT",
                          "degrees");
}

void declare_timing(CommandOptions& command, Options& options) {
  command.group("Time");
  add_rate(command, "--fps", options.fps, "Frame rate of the file, overrides the file's value");
  add_rate(command, "--resample", options.resample, "Resample the motion to N frames per second");
  add_choice<RestFrame>(
      command, "--skip-rest-frame", options.rest_frame,
      {{"no", RestFrame::keep}, {"auto", RestFrame::automatic}, {"yes", RestFrame::drop}},
      "Drop the first frame of a capture: auto (if it is a rest pose, not part of the motion), yes "
      "or no",
      "WHEN", "no");
}

void declare_faults(CommandOptions& command, Options& options) {
  command.group("Errors in the file");
  const CommandOption strict = command.add_flag(
      "--strict", options.strict,
      "Fail on any error in the file; by default incomplete rows are dropped with a warning");
  command
      .add_flag("--repair", options.repair,
                "Fill damaged frames from their neighbours; each repair is listed")
      .excludes(strict);
}

}  // namespace

void declare(CommandOptions& command, Options& options) {
  declare_inputs(command, options);
  declare_characters(command, options);
  declare_conventions(command, options);
  declare_timing(command, options);
  declare_faults(command, options);
  add_orientation_option(command, options.orientation);
}

Result<io::CaptureReading> read_options(const Options& options) {
  io::CaptureReading result;
  if (options.unit != "auto") {
    auto unit = parse_unit(options.unit);
    if (!unit) {
      return Error("usage", "--unit: " + unit.error().message, unit.error().hint);
    }
    result.unit = *unit;
  }
  const auto up = direction_option(options.up, "--up");
  if (!up) return up.error();
  result.up = *up;
  const auto forward = direction_option(options.forward, "--forward");
  if (!forward) return forward.error();
  result.forward = *forward;
  if (result.up && result.forward) {
    const auto rotation = rotation_to_krok(*result.up, *result.forward);
    if (!rotation) return Error("usage", rotation.error().message, rotation.error().hint);
  }
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

namespace {

Status check(const Options& options) {
  if (const auto how = read_options(options); !how) return how.error();
  if (!options.character.empty() && !(options.model.empty() && options.morphs.empty())) {
    return Error("usage", "--character already writes model and morph targets",
                 "remove --model and --morphs");
  }
  if (Status status =
          check_output_kind(options.character, "--character", registry::Kind::character);
      !status) {
    return status;
  }
  if (options.character == "-") {
    return Error("usage", "--character -: several files cannot go to standard output");
  }
  return check_output_kind(options.model, "--model", registry::Kind::model);
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-import", options, declare, check, run);
  spec.summary = "Converts motion captures and characters to Krok's formats";
  spec.details =
      "Captures: BVH, Acclaim. Characters: glTF (meshopt and Draco, too), FBX, COLLADA, SMD, MS3D, "
      "3DS, ASE, MD5.";
  spec.inputs = "IN";
  spec.needs_output = false;  // --model or --cam alone is enough
  spec.examples = {
      {"krok-import walk.bvh -o walk.anim -v", "detects unit and axes and prints them"},
      {"krok-import take7.bvh -o take7.anim --model actor.model --unit in --up z --forward -y",
       "a capture in inches with +Z up, and its skeleton as a model"},
      {"krok-import 01_01.amc --skeleton 01.asf -o walk.anim",
       "an Acclaim motion with its skeleton, as in the CMU database"},
      {"krok-import hero.glb --clip Walk -o walk.anim --model hero.model --cam shot.cam",
       "one animation of a character, its mesh and skin, and the camera"},
      {"krok-import hero.glb --clip all -o 'hero_{clip}.anim' --morphs face.exr",
       "all animations, one file each, and the morph targets"},
      {"krok-import hero.glb --character hero.character",
       "the whole character: mesh, materials, textures and expressions"},
      {"krok-import broken.bvh -o broken.anim --repair --json",
       "repairs damaged frames and lists the repairs for a script"},
      {"krok-import captures --out-dir motions --keep-going",
       "all captures in a folder; run again, it processes only new, changed and failed files"}};
  // Only files with motion; an Acclaim skeleton or an MD5 mesh is read with the motion beside it.
  spec.batch = {io::foreign_motion_endings(), [options]() -> Result<std::string> {
                  return std::string(options->clip == "all" ? "_{clip}.anim" : ".anim");
                }};
  return spec;
}

}  // namespace krok::cli::import
