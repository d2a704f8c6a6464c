#pragma once

#include <string>

#include "core/file.h"
#include "core/result.h"
#include "formats/io/open_role_map.h"
#include "formats/registry/registry.h"
#include "scene/model.h"
#include "scene/skeleton.h"
#include "tools/cli/tool.h"
#include "tools/krok-info/description.h"

// One function per kind of file. Each reads the whole file, so that the file is also validated;
// reader warnings go to the context.

namespace krok::cli::info {

// How joint roles are found and printed.
struct SkeletonOptions {
  io::FindRoles roles;
  bool mapped = false;   // by a role map that the user gave
  bool verbose = false;  // list every joint
};

// Joints, end sites, body parts, missing humanoid roles and stature. Lists each joint with its role
// in JSON, and with `verbose` also in the text. An Error if the map does not match the skeleton.
Status add_skeleton(const Skeleton& skeleton, const SkeletonOptions& options, Description& out);
// The same for known roles; `metres` is the skeleton's unit.
void add_skeleton(const Skeleton& skeleton, const RoleMap& map, bool verbose, double metres,
                  Description& out);

Result<Description> describe_anim(const InputFile& file, const SkeletonOptions& how,
                                  ToolContext& context);
Result<Description> describe_model(const InputFile& file, const SkeletonOptions& how,
                                   ToolContext& context);
Result<Description> describe_cam(const InputFile& file, ToolContext& context);
Result<Description> describe_steps(const InputFile& file, ToolContext& context);
// Bodies and joints; without their skeleton.
Result<Description> describe_ragdoll(const InputFile& file, ToolContext& context);
Result<Description> describe_correctives(const InputFile& file, ToolContext& context);
// Morph targets (OpenEXR).
Result<Description> describe_morphs(const InputFile& file, ToolContext& context);
Result<Description> describe_textgrid(const InputFile& file, ToolContext& context);
Result<Description> describe_material(const InputFile& file, ToolContext& context);
// A character with the files that it refers to; joint roles are its own unless `how` has a role
// map.
Result<Description> describe_character(const InputFile& file, const SkeletonOptions& how,
                                       ToolContext& context);
Result<Description> describe_bvh(const InputFile& file, const SkeletonOptions& how,
                                 ToolContext& context);
// A skeleton, or a motion with the skeleton beside it.
Result<Description> describe_acclaim(const InputFile& file, const SkeletonOptions& how,
                                     ToolContext& context);
// Any other motion of the table of formats (formats/io/formats.h).
Result<Description> describe_motion(const InputFile& file, const SkeletonOptions& how,
                                    ToolContext& context);
// glTF, and formats read through Assimp.
Result<Description> describe_scene(const InputFile& file, registry::Kind kind,
                                   const SkeletonOptions& how, ToolContext& context);

// The parts of a mesh and their materials.
void add_parts(const Model& model, Description& out);
// Size of the mesh, or of the skeleton without a mesh, and volume.
void add_mesh_size(const Model& model, Description& out);

}  // namespace krok::cli::info
