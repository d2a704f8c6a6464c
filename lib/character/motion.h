#pragma once

#include <vector>

#include "capture/convention_choice.h"
#include "character/rig.h"
#include "character/sampling.h"
#include "core/progress.h"
#include "core/result.h"
#include "scene/camera_track.h"
#include "scene/clip.h"
#include "scene/stretch.h"

// Samples the motions of a scene at even times, in Krok's frame.

namespace krok::character {

// A rig's skeleton in Krok's frame. An Error (code scene-value) if a joint is over 1e9 m away.
Result<Skeleton> skeleton_in_krok(const Rig& rig, const Conversion& conversion);

// The motion of a rig in one of the scene's animations.
//
// Where joint scales or shears differ from the bind pose by more than 1e-4, `stretches` gets them
// for all joints and frames, and a note gives the worst joint, its frame and the amount (code
// scene-scale); otherwise it is left empty. Without `stretches` the rigid parts alone are kept,
// with a warning from 0.1 % on.
//
// Errors: scene-too-long (more than 100 million joint transforms), scene-value (positions or scales
// that overflow).
Result<Clip> make_clip(const nodes::Evaluator& evaluator, const Rig& rig,
                       const Conversion& conversion, int animation, const Sampling& sampling,
                       int jobs, Progress* progress, Diagnostics& diagnostics,
                       Stretches* stretches = nullptr);

// Joint positions in the rig's own frame at up to `most` sampled frames, [frames x joints], for
// find_conventions.
std::vector<Vec3> sample_positions(const nodes::Evaluator& evaluator, const Rig& rig, int animation,
                                   const Sampling& sampling, int most);

// The camera nodes of the displayed scene, in outliner order.
std::vector<int> camera_nodes(const nodes::Scene& scene, const nodes::Evaluator& evaluator);

// A camera over time; animation -1 gives a static camera. An orthographic camera has no field of
// view: 45 degrees is used, with a warning (code scene-camera). `to_axes` as in Rig.
Result<CameraTrack> make_camera(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                int node, const Conversion& conversion, const Mat4& to_axes,
                                int animation, const Sampling& sampling, Diagnostics& diagnostics);

}  // namespace krok::character
