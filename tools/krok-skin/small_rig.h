#pragma once

#include "core/result.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/joint_tracks.h"
#include "tools/cli/tool.h"
#include "tools/krok-skin/subject.h"

// Options of krok-skin that make files smaller at a cost that is measured on the mesh.

namespace krok::cli::skin {

// Applies --influences to the model, and reports how far vertices move by it over the motion.
void apply_influence_limit(const Options& options, Subject& subject, ToolContext& context);

// What --as rig writes, with --reduce, --quantize and --compress applied.
struct SmallRig {
  Model model;
  MorphSet morphs;
  gltf::JointTracks tracks;
};

// Reports the error of what is lost. Warns where the file needs a second set of influences. Codes:
// those of joint_tracks() and reduce_for_mesh().
Result<SmallRig> small_rig(const Options& options, const Subject& subject, ToolContext& context);

}  // namespace krok::cli::skin
