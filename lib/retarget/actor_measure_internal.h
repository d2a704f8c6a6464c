#pragma once

#include <algorithm>
#include <span>

#include "math/types.h"
#include "retarget/joint_mapping.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Measures of figures that the parts of retargeting share.

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

// Metres between two joints in the reference pose; 0 where one is -1.
double length_of(const Skeleton& skeleton, int from, int to);

// The mean length of thigh and shank of both legs, metres; what the roles do not know counts as 0.
double leg_length(const Skeleton& skeleton, const RoleMap& roles);

// The ratio of the lengths of all bones that both figures have, by a mapping by names; 1 where they
// share none.
double bone_ratio(const Skeleton& source, const Skeleton& target, const JointMapping& mapping);

// Whether no finger of a hand ever leaves the place on its hand that it has in `rest`, shape
// [joints], by more than half a degree. False for a hand without fingers.
bool fingers_never_move(const Clip& source, const RoleMap& roles, std::span<const Transform> rest,
                        Role hand, Role fingers);

}  // namespace krok::retarget
