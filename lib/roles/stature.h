#pragma once

#include <optional>
#include <span>

#include "math/types.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok {

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
