#pragma once

#include <algorithm>
#include <span>

#include "math/types.h"
#include "retarget/joint_mapping.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Skeleton measurements shared by the parts of retargeting.

namespace krok::retarget {

inline const Vec3 kUp = Vec3::UnitY();

// The horizontal part.
inline Vec3 flat(const Vec3& v) {
  return {v.x(), 0, v.z()};
}

// 0 up to `from`, 1 beyond `to`, 3t^2 - 2t^3 between them.
inline double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// Metres between two joints in the reference pose; 0 if either is -1.
double length_of(const Skeleton& skeleton, int from, int to);

// Mean length of thigh and shank of both legs, metres; bones without a role count as 0.
double leg_length(const Skeleton& skeleton, const RoleMap& roles);

// Total length of the bones that both skeletons have, target over source, for a mapping by names; 1
// if they share none.
double bone_ratio(const Skeleton& source, const Skeleton& target, const JointMapping& mapping);

// Whether no finger of a hand ever rotates relative to the palm by more than half a degree from
// `rest`, shape [joints]. False for a hand without fingers.
bool fingers_never_move(const Clip& source, const RoleMap& roles, std::span<const Transform> rest,
                        Role hand, Role fingers);

}  // namespace krok::retarget
