#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "capture/convention_choice.h"
#include "character/rig.h"
#include "character/sampling.h"
#include "core/progress.h"
#include "core/result.h"
#include "nodes/evaluate.h"
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

// What a motion loses by being sampled: between its frames glTF's loaders interpolate position and
// rotation of each joint relative to its parent, whatever the keys of the source did there.

struct SamplingError {
  double largest = 0;  // metres: of a joint's position between two frames
  int joint = -1;      // index in the rig
  double time = 0;     // of the result, seconds
  bool jumps = false;  // a key steps, which becomes a ramp of one frame at any rate
  // A multiple of the rate at which it is at most `wanted`; none up to 32 times.
  std::optional<double> rate;
};

// Whether an animation can lose anything: it has keys between frames, splines or steps.
bool is_sampled_exactly(const nodes::Animation& animation, const Sampling& sampling);

// Measured at the quarters between frames. `wanted` in metres.
SamplingError sampling_error(const nodes::Evaluator& evaluator, const Rig& rig,
                             const Conversion& conversion, const nodes::Animation& animation,
                             int index, const Sampling& sampling, double wanted, int jobs);

// A scene's skeleton and motions in Krok's frame, from what the file says, the user gives or the
// character shows.

// choose_joints() and make_rig().
Result<Rig> find_rig(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                     const std::string& skin, Diagnostics& diagnostics);

// find_conventions() of an animation's poses (-1: none). `rig` may be null; `roles` are those of
// its joints.
Result<Conventions> scene_conventions(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                      const Rig* rig, const RoleMap& roles, int animation,
                                      const GivenConventions& given);

// Where a scene is in Krok's frame.
struct ScenePlace {
  Conventions conventions;
  Conversion conversion;
  std::vector<std::string> conversions;  // for Provenance::conversions
};

// From scene_conventions(), reported as report_conventions() does (prefix "scene") with `path` as
// the file, and with check_size() and check_actor() of what was not detected.
Result<ScenePlace> place_scene(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                               const Rig* rig, const RoleMap& roles, int animation,
                               const CaptureOptions& how, const std::string& path,
                               Diagnostics& diagnostics);

// make_clip(), with the conversions in its provenance and a warning if the first frame is a rest
// pose (code import-rest-frame). `roles` are those of the rig's joints.
Result<Clip> make_motion(const nodes::Evaluator& evaluator, const Rig& rig, const RoleMap& roles,
                         const ScenePlace& place, int animation, const ChosenSampling& sampling,
                         int jobs, Progress* progress, Diagnostics& diagnostics,
                         Stretches* stretches);

}  // namespace krok::character
