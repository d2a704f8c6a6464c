#include "tools/krok-import/options.h"

#include <fmt/format.h>

#include "tools/common/option_kinds.h"
#include "tools/common/orientation_option.h"

namespace krok::import {

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

}  // namespace

void declare_options(CommandOptions& command, Options& options) {
  command
      .add_option("input", options.input,
                  "Motion capture (BVH; Acclaim motion, AMC; Acclaim skeleton, ASF) or character "
                  "(GLB, glTF, FBX, COLLADA, SMD, MS3D, 3DS, ASE, MD5); - is standard input")
      .type_name("IN")
      .required();
  command
      .add_option("--skeleton", options.skeleton,
                  "Skeleton of an Acclaim motion; default: the .asf file beside it whose name "
                  "starts the motion's name, or the only one")
      .type_name("IN.asf");
  add_map_option(command, options.map);
  command
      .add_option("--model", options.model,
                  "Write the model: skeleton with reference pose, mesh and skin; for a capture the "
                  "skeleton without vertices")
      .type_name("OUT.model");

  const std::string scene = "Characters";
  command
      .add_option("--character", options.character,
                  "Write the whole character: OUT.character and beside it OUT.model, OUT.material, "
                  "textures in OUT_textures/, morph targets in OUT_morphs.exr; replaces --model "
                  "and --morphs")
      .type_name("OUT.character")
      .group(scene);
  command
      .add_option("--clip", options.clip,
                  "Animation to import: name, number from 0, or all; for all, {clip} in the "
                  "output's name is the animation's name [the first]")
      .type_name("NAME")
      .group(scene);
  command
      .add_option("--skin", options.skin,
                  "Use the skeleton of this skin (name or number) if the file has several [the one "
                  "with the most joints]")
      .type_name("NAME")
      .group(scene);
  command.add_option("--cam", options.cam, "Write a camera of the file")
      .type_name("OUT.cam")
      .group(scene);
  command
      .add_option("--camera", options.camera, "Camera to write: name or number from 0 [the first]")
      .type_name("NAME")
      .group(scene);

  command
      .add_option("--morphs", options.morphs,
                  "Write the morph targets as a float texture (OpenEXR), for the vertices that "
                  "--model writes")
      .type_name("OUT.exr")
      .group(scene);
  command
      .add_option("--morph-weights", options.weights,
                  "Write the morph target weights over time as a table")
      .type_name("OUT.csv")
      .group(scene);

  const std::string space = "Conventions of the file";
  command
      .add_option("--unit", options.unit,
                  "Unit of length: auto, m, dm, cm, mm, in, ft, cmu (of the CMU database) or a "
                  "length such as 5.64cm")
      .type_name("UNIT")
      .default_str("auto")
      .group(space);
  command.add_option("--up", options.up, "Up axis: auto, x, y, z, -x, -y, -z")
      .type_name("AXIS")
      .default_str("auto")
      .group(space);
  command
      .add_option("--forward", options.forward,
                  "Axis that the character faces in the reference pose: as --up")
      .type_name("AXIS")
      .default_str("auto")
      .group(space);
  add_choice<bvh::Positions>(
      command, "--positions", options.positions,
      {{"auto", bvh::Positions::automatic},
       {"absolute", bvh::Positions::absolute},
       {"additive", bvh::Positions::additive}},
      "BVH: whether position channels replace OFFSETs (absolute) or are added to them (additive)",
      "HOW", "auto")
      .group(space);
  add_choice<bvh::Angles>(command, "--angles", options.angles,
                          {{"degrees", bvh::Angles::degrees}, {"radians", bvh::Angles::radians}},
                          "BVH: unit of rotations: degrees, the format's unit, or radians", "UNIT",
                          "degrees")
      .group(space);

  const std::string time = "Time";
  add_rate(command, "--fps", options.fps, "Frame rate of the file, overrides the file's value")
      .group(time);
  add_rate(command, "--resample", options.resample, "Resample the motion to N frames per second")
      .group(time);
  add_choice<RestFrame>(
      command, "--skip-rest-frame", options.rest_frame,
      {{"no", RestFrame::keep}, {"auto", RestFrame::automatic}, {"yes", RestFrame::drop}},
      "Drop the first frame of a capture: auto (if it is a rest pose, not part of the motion), yes "
      "or no",
      "WHEN", "no")
      .group(time);

  const std::string faults = "Errors in the file";
  const CommandOption strict = command
                                   .add_flag("--strict", options.strict,
                                             "Fail on any error in the file; by default incomplete "
                                             "rows are dropped with a warning")
                                   .group(faults);
  command
      .add_flag("--repair", options.repair,
                "Fill damaged frames from their neighbours; each repair is listed")
      .excludes(strict)
      .group(faults);

  add_orientation_option(command, options.orientation);
}

Result<CaptureOptions> read_options(const Options& options) {
  CaptureOptions result;
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
  result.strictness = options.strict   ? Strictness::strict
                      : options.repair ? Strictness::repair
                                       : Strictness::normal;
  return result;
}

}  // namespace krok::import
