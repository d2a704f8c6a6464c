#pragma once

#include <optional>
#include <span>

#include "math/transform.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/skeleton.h"

namespace krok {

// The rotation that takes +X, +Y and +Z to where left, up and ahead are of the body in the
// reference pose, by hips, shoulders and head: captures keep reference poses that lie, or face any
// way. Within 30 degrees of the axes it is the nearest of them, as bodies lean and heads bow. The
// identity where the roles are not known or the body has no width or height.
Quat body_frame(const Skeleton& skeleton, const RoleMap& roles);

// Where the body faces in the reference pose, radians about +Y as a heading: 0, but for rigs that
// keep another facing than their file format's (VRM 0: half a turn). 0 for a body that lies. What
// ground_frame() calls a heading (motion/hips_root.h) is relative to this.
double front_of(const Skeleton& skeleton, const RoleMap& roles);

// The heading of a body whose joints are at these places, by the same joints: radians about +Y, 0
// is +Z and pi/2 is +X. Nothing where the roles are not known, or for a body that lies on its back
// or belly.
std::optional<double> heading_of(const RoleMap& roles, std::span<const Transform> joints);

// The clip's skeleton, in which the reference orientations of trunk, neck and head are those that
// they have in a body that looks ahead: as in the reference pose, unless they are turned from it by
// over 45 degrees on the average of the motion. Reference poses of some captures have a head that
// is twisted by a quarter turn.
Skeleton facing_skeleton(const Clip& clip, const RoleMap& roles);

// A body's standing height, sole to crown, estimated from the lengths of its segments: the same for
// all takes and poses of a skeleton.
struct Stature {
  double metres = 0;       // in the unit of the positions
  double uncertainty = 0;  // how far the estimates of single segments differ from it at most
};

// From positions of joints in any pose, shape [joints]: legs (hip to ankle, 0.49 of the stature)
// and spine (hips to head joint, 0.37) together, else the legs, else the arms (shoulder to wrist,
// 0.33). Each of them alone gives an estimate, too; with a single one the uncertainty is a tenth,
// about what proportions vary between people. Empty without legs and arms, or if they have no
// length. Source: segment lengths in Winter, Biomechanics and Motor Control of Human Movement.
std::optional<Stature> stature_of(const Skeleton& skeleton, const RoleMap& roles,
                                  std::span<const Vec3> pose);

// In the reference pose.
std::optional<Stature> stature_of(const Skeleton& skeleton, const RoleMap& roles);

}  // namespace krok
