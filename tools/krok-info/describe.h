#pragma once

#include "core/file.h"
#include "core/result.h"
#include "formats/io/open_motion.h"
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

using Describe = Result<Description>(const InputFile& file, const SkeletonOptions& how,
                                     ToolContext& context);
Describe describe_anim, describe_bvh, describe_cam, describe_correctives, describe_material,
    describe_model, describe_steps, describe_textgrid;
Describe describe_acclaim;    // a skeleton, or a motion with the skeleton beside it
Describe describe_character;  // with its files; joint roles are its own unless `how` has a role map
Describe describe_morphs;     // morph targets (OpenEXR)
Describe describe_motion;     // any other motion of the table of formats (formats/io/formats.h)
Describe describe_ragdoll;    // bodies and joints, without their skeleton
// glTF, and formats read through Assimp.
Result<Description> describe_scene(const InputFile& file, registry::Kind kind,
                                   const SkeletonOptions& how, ToolContext& context);

// The parts of a mesh and their materials.
void add_parts(const Model& model, Description& out);
// Size of the mesh, or of the skeleton without a mesh, and volume.
void add_mesh_size(const Model& model, Description& out);

}  // namespace krok::cli::info
