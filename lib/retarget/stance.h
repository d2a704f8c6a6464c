#pragma once

#include <optional>
#include <vector>

#include "core/result.h"
#include "retarget/pose_alignment.h"
#include "scene/clip.h"

namespace krok::retarget {

// The pose that a figure's turns are counted from.
struct Stance {
  std::vector<Transform> pose;  // joint_to_world, shape [joints]
  std::optional<int> frame;     // of the motion; nothing for the skeleton's reference pose
};

// Whether a human figure stands in a pose: trunk, thighs and shanks within 60 degrees of upright.
// Exporters whose bones all lie along one axis have reference poses that do not.
bool stands(const Actor& actor);

// The reference pose of a clip's skeleton; where it does not stand, the frame that comes nearest to
// a T-pose among up to 2,000 evenly spaced ones, if any stands, with its legs straightened and its
// feet set flat. `frame` chooses a frame's pose outright; an
// Error (code retarget-frame) where there is none of that number. Figures that are no humanoids
// keep their reference pose.
Result<Stance> find_stance(const Clip& clip, const RoleMap& roles, std::optional<int> frame);

}  // namespace krok::retarget
