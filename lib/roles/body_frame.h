#pragma once

#include "roles/roles.h"
#include "scene/clip.h"

namespace krok {

// The rotation that takes +X, +Y and +Z to where left, up and ahead are of the body in the
// reference pose, by hips, shoulders and head: captures keep reference poses that lie, or face any
// way. Within 30 degrees of the axes it is the nearest of them, as bodies lean and heads bow. The
// identity where the roles are not known or the body has no width or height.
Quat body_frame(const Skeleton& skeleton, const RoleMap& roles);

// The clip's skeleton, in which the reference orientations of trunk, neck and head are those that
// they have in a body that looks ahead: as in the reference pose, unless they are turned from it by
// over 45 degrees on the average of the motion. Reference poses of some captures have a head that
// is twisted by a quarter turn.
Skeleton facing_skeleton(const Clip& clip, const RoleMap& roles);

}  // namespace krok
