#pragma once

#include <vector>

#include "capture/convention_choice.h"
#include "character/rig.h"
#include "character/sampling.h"
#include "core/progress.h"
#include "core/result.h"
#include "scene/camera_track.h"
#include "scene/clip.h"

// What moves in a scene, at even times and in Krok's frame.

namespace krok::character {

// A rig's skeleton in Krok's frame. An Error (code scene-value) where positions overflow floats.
Result<Skeleton> skeleton_in_krok(const Rig& rig, const Conversion& conversion);

// The motion of a rig in one of the scene's animations. Where joints are scaled otherwise than in
// the bind pose, which a clip cannot hold, the rigid part is taken and one warning names the worst
// joint, its frame and by how much (code scene-scale). Errors: scene-too-long (more than 100
// million joint transforms), scene-value (positions that overflow).
Result<Clip> make_clip(const nodes::Evaluator& evaluator, const Rig& rig,
                       const Conversion& conversion, int animation, const Sampling& sampling,
                       int jobs, Progress* progress, Diagnostics& diagnostics);

// Whether an animation moves the rig: a joint or a node above all of them. Animations of cameras
// and of morph targets do not.
bool moves_rig(const nodes::Scene& scene, const Rig& rig, int animation);

// Joint positions in the rig's own frame at up to `most` moments, [moments x joints], for
// find_conventions.
std::vector<Vec3> sample_positions(const nodes::Evaluator& evaluator, const Rig& rig, int animation,
                                   const Sampling& sampling, int most);

// The nodes of the scene that is shown which are cameras, in the order of its outline.
std::vector<int> camera_nodes(const nodes::Scene& scene, const nodes::Evaluator& evaluator);

// A camera over time; animation -1 is a camera that stands still. An orthographic camera has no
// field of view: 45 degrees are taken, with a warning (code scene-camera). `to_axes` as in Rig.
Result<CameraTrack> make_camera(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                int node, const Conversion& conversion, const Mat4& to_axes,
                                int animation, const Sampling& sampling, Diagnostics& diagnostics);

}  // namespace krok::character
