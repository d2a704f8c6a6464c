#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "retarget/joint_mapping.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

// Aligns a target's reference pose with that of a source, whatever stance either has: T-pose,
// A-pose, arms forward.
//
// For each target joint, the world rotation that, applied to its reference orientation, makes its
// bone point as the source's does in the source's reference pose. Hips and chest are aligned by
// their left-right and up directions; a lean of the trunk counts as body build, not as a bend,
// unless it is large. Limbs are aligned bone by bone, each by the smallest angle beyond its
// parent's rotation, so that no twist is added. Collars are aligned only where they are raised or
// lowered together with the arm; other differences are body build, too. A hand is aligned by the
// direction of its fingers and of its knuckles (or thumbs, if one side has no more). Feet are
// turned about the vertical only, since soles are flat in a stance whatever the height of the
// ankle and the stoop of the trunk, unless the legs lean with the trunk, or their pitch differs by
// more than 30 degrees and neither is level, or one points up or down. Where the source's soles are
// tilted to the side, as in reference poses whose legs are spread with the feet as they are below
// upright ones, the target's are, too.

namespace krok::retarget {

// A skeleton in a pose, with its joint roles.
struct Actor {
  const Skeleton& skeleton;
  const RoleMap& roles;
  std::span<const Transform> pose;  // joint_to_world, shape [joints]
};

// Shape [target joints]; unmapped joints get the rotation of their parent. `heels` are those of the
// source's left and right foot in the ankles' frames, metres, as they are in stance; none if
// unknown.
std::vector<Quat> align_by_roles(const Actor& source, const Actor& target,
                                 const JointMapping& mapping,
                                 const std::array<std::optional<Vec3>, 2>& heels = {});

// For skeletons mapped by names: each joint is rotated so that the bones to its mapped children
// point as the source's; without such children it gets the rotation of its parent.
std::vector<Quat> align_by_names(const Actor& source, const Actor& target,
                                 const JointMapping& mapping);

// The joint that shows where a foot points: one of its first toe joints, or the end site of the
// foot. -1 if it has neither.
int foot_front(const Skeleton& skeleton, const RoleMap& roles, Role foot);

}  // namespace krok::retarget
