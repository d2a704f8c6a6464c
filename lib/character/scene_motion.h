#pragma once

#include <string>
#include <vector>

#include "capture/capture.h"
#include "character/motion.h"
#include "character/rig.h"
#include "character/sampling.h"
#include "core/result.h"
#include "nodes/evaluate.h"

// A scene's skeleton and motions in Krok's frame, from what the file says, the user gives or the
// character shows.

namespace krok::character {

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
