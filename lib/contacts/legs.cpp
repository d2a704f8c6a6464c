#include "contacts/legs.h"

#include <algorithm>
#include <cmath>

#include "math/hermite.h"
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

double beside_for_hips(double width, double other_width, double leg) {
  constexpr double kUsual = 0.06, kOther = 0.12;  // of the leg
  const double wider = 0.5 * (width - other_width);
  const double share = (std::abs(wider) - kUsual * leg) / ((kOther - kUsual) * leg);
  return leg > 0 ? smoother_step(share) * wider : 0;
}

}  // namespace krok
