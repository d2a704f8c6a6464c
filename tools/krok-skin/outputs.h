#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/joint_tracks.h"
#include "skin/skin.h"
#include "tools/cli/tool.h"
#include "tools/krok-skin/subject.h"

// The files that krok-skin writes. The output's extension determines the kind.

namespace krok::cli::skin {

// Checks that the output's format can hold this kind of output. Codes skin-format, skin-output.
Status check_output(As as, const std::string& output);

// One mesh, at a time in seconds.
Status write_pose(const Subject& subject, const SkinBinding& binding, double seconds,
                  ToolContext& context);

// The whole motion as an animated mesh; says how large it is if it is over 50 MB. Codes
// skin-no-frames, skin-clip-too-long.
Status write_baked(const Subject& subject, const SkinBinding& binding, pc2::Up up,
                   ToolContext& context);

// Joints, weights and the animations of all motions. False if the error is larger than --reduce
// allows.
Result<bool> write_rig(const Options& options, const Subject& subject, ToolContext& context);

// The same without the mesh.
Status write_motion(const Subject& subject, ToolContext& context);

// One file per frame, written in parallel; all appear or none. Returns their names for display:
// "walk_0000.glb to walk_0119.glb".
Result<std::string> write_frames(const Subject& subject, const SkinBinding& binding,
                                 ToolContext& context);

// Options of krok-skin that make files smaller at a cost that is measured on the mesh.

// Applies --influences to the model, and reports how far vertices move by it over the motion.
void apply_influence_limit(const Options& options, Subject& subject, ToolContext& context);

// The animations of all motions of a subject.
struct Clips {
  std::vector<std::string> names;
  std::vector<gltf::JointTracks> tracks;
  std::vector<const MorphWeights*> weights;  // of the subject
  // Refers to both.
  std::vector<gltf::NamedTracks> named() const;
};

// Reports joints that shear. `still_name` is that of a reference pose in which shapes change.
// Codes: those of joint_tracks().
Result<Clips> clips_of(const Subject& subject, const std::string& still_name, ToolContext& context);

// What --as rig writes, with --reduce, --quantize and --compress applied.
struct SmallRig {
  Model model;
  MorphSet morphs;
  Clips clips;
  std::optional<gltf::Quantization> quantization = {};
  std::vector<std::uint32_t> places = {};             // of vertices, if reordered
  std::vector<gltf::JointTracks> all_keys = {};       // as `clips` before --reduce, --quantize
  std::vector<const MorphWeights*> all_weights = {};  // the same
  std::deque<MorphWeights> few_weights = {};          // of `clips` after them, where they have some
  Json facts = {};                                    // about --reduce and --quantize, if given
};

// Warns where the file needs a second set of influences. Codes:
// those of joint_tracks() and reduce_for_mesh().
Result<SmallRig> small_rig(const Options& options, const Subject& subject,
                           const std::string& still_name, ToolContext& context);

// Measures what the file that is written at `path` lost of the subject, and reports it. False if
// that is more than --reduce allows. Codes: those of written_error().
Result<bool> report_loss(const std::string& path, const Options& options, const Subject& subject,
                         SmallRig& rig, ToolContext& context);

}  // namespace krok::cli::skin
