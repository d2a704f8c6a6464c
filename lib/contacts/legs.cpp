#include "contacts/legs.h"

#include <algorithm>

#include "roles/roles.h"

namespace krok {

LegJoints leg_joints(const RoleMap& roles, FootSide side) {
  const LegRoles& leg = kLegRoles[static_cast<std::size_t>(side)];
  return {roles.joint(leg.upper), roles.joint(leg.lower), roles.joint(leg.foot),
          roles.joint(leg.toes)};
}

bool is_below(const Skeleton& skeleton, int joint, int ancestor) {
  while (joint >= 0 && joint != ancestor) joint = skeleton.parents[static_cast<std::size_t>(joint)];
  return joint >= 0;
}

const SolePoint* point_of(std::span<const SolePoint> points, FootPart part) {
  const auto found = std::ranges::find(points, part, &SolePoint::part);
  return found == points.end() ? nullptr : &*found;
}

}  // namespace krok
