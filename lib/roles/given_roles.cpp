// find_roles with roles given by the user.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/index.h"
#include "roles/joint_names.h"
#include "roles/role_finder_internal.h"
#include "roles/roles.h"

namespace krok {

namespace {

// The part and side that a joint name of this role would have.
JointName name_of(Role role) {
  switch (role) {
    case Role::hips:
      return {Part::hips, Side::middle};
    case Role::spine:
    case Role::chest:
      return {Part::spine, Side::middle};
    case Role::neck:
      return {Part::neck, Side::middle};
    case Role::head:
      return {Part::head, Side::middle};
    case Role::left_collar:
      return {Part::collar, Side::left};
    case Role::left_upper_arm:
      return {Part::upper_arm, Side::left};
    case Role::left_lower_arm:
      return {Part::lower_arm, Side::left};
    case Role::left_hand:
      return {Part::hand, Side::left};
    case Role::right_collar:
      return {Part::collar, Side::right};
    case Role::right_upper_arm:
      return {Part::upper_arm, Side::right};
    case Role::right_lower_arm:
      return {Part::lower_arm, Side::right};
    case Role::right_hand:
      return {Part::hand, Side::right};
    case Role::left_upper_leg:
      return {Part::upper_leg, Side::left};
    case Role::left_lower_leg:
      return {Part::lower_leg, Side::left};
    case Role::left_foot:
      return {Part::foot, Side::left};
    case Role::left_toes:
      return {Part::toes, Side::left};
    case Role::right_upper_leg:
      return {Part::upper_leg, Side::right};
    case Role::right_lower_leg:
      return {Part::lower_leg, Side::right};
    case Role::right_foot:
      return {Part::foot, Side::right};
    case Role::right_toes:
      return {Part::toes, Side::right};
    case Role::helper:
      return {Part::helper, Side::middle};
    default:
      return {};
  }
}

Status check_once(const Skeleton& skeleton, std::span<const GivenRole> given) {
  for (std::size_t i = 0; i < given.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const bool one_phalanx = given[i].finger.finger != Finger::none &&
                               given[i].finger.phalanx != FingerJoint::kTip &&
                               given[i].finger == given[k].finger;
      if (given[i].role != given[k].role || (is_role_of_many(given[i].role) && !one_phalanx)) {
        continue;
      }
      Error error(
          "role-twice",
          fmt::format("'{}' and '{}' were given the same role", skeleton.names[at(given[k].joint)],
                      skeleton.names[at(given[i].joint)]),
          "only one joint can have this role; remove one of the two");
      error.joint = skeleton.names[at(given[i].joint)];
      return error;
    }
  }
  return {};
}

// Pairs of roles; the second joint must be a descendant of the first.
constexpr std::array<std::array<Role, 2>, 20> kOrder = {{
    {Role::hips, Role::chest},
    {Role::hips, Role::head},
    {Role::hips, Role::left_upper_leg},
    {Role::hips, Role::right_upper_leg},
    {Role::hips, Role::left_upper_arm},
    {Role::hips, Role::right_upper_arm},
    {Role::chest, Role::head},
    {Role::neck, Role::head},
    {Role::left_collar, Role::left_upper_arm},
    {Role::left_upper_arm, Role::left_lower_arm},
    {Role::left_upper_arm, Role::left_hand},
    {Role::left_lower_arm, Role::left_hand},
    {Role::right_collar, Role::right_upper_arm},
    {Role::right_upper_arm, Role::right_lower_arm},
    {Role::right_upper_arm, Role::right_hand},
    {Role::right_lower_arm, Role::right_hand},
    {Role::left_upper_leg, Role::left_lower_leg},
    {Role::left_lower_leg, Role::left_foot},
    {Role::right_upper_leg, Role::right_lower_leg},
    {Role::right_lower_leg, Role::right_foot},
}};

Status check_order(const Skeleton& skeleton, const RoleMap& map, std::span<const GivenRole> given) {
  const auto is_given = [&](Role role) {
    return std::any_of(given.begin(), given.end(),
                       [role](const GivenRole& entry) { return entry.role == role; });
  };
  for (const auto& [above, below] : kOrder) {
    if (!is_given(above) && !is_given(below)) continue;
    const int upper = map.joint(above);
    const int lower = map.joint(below);
    if (upper < 0 || lower < 0) continue;
    int joint = skeleton.parents[at(lower)];
    while (joint >= 0 && joint != upper) joint = skeleton.parents[at(joint)];
    if (joint == upper) continue;
    const Role told = is_given(below) ? below : above;
    Error error(
        "role-order",
        fmt::format("'{}' is {} and '{}' is {}, but the latter is not a descendant of the former",
                    skeleton.names[at(upper)], role_name(above), skeleton.names[at(lower)],
                    role_name(below)),
        "give the other joint a role too, or this one a different role");
    error.joint = skeleton.names[at(map.joint(told))];
    return error;
  }
  return {};
}

std::vector<JointName> names_with(const Skeleton& skeleton, std::span<const GivenRole> given) {
  std::vector<JointName> names = read_joint_names(skeleton);
  const bool unknown = std::all_of(names.begin(), names.end(), [](const JointName& name) {
    return name.part == Part::unknown || name.part == Part::helper;
  });
  if (unknown) {
    if (auto by_shape = names_from_shape(skeleton)) names = std::move(*by_shape);
  }
  for (const GivenRole& entry : given) {
    const JointName told = name_of(entry.role);
    if (is_role_of_many(entry.role) || entry.role == Role::chest) continue;
    for (JointName& name : names) {
      if (name.part == told.part && name.side == told.side) name = {};
    }
  }
  for (const GivenRole& entry : given) names[at(entry.joint)] = name_of(entry.role);
  return names;
}

}  // namespace

Result<RoleMap> find_roles(const Skeleton& skeleton, std::span<const GivenRole> given) {
  if (given.empty()) return find_roles(skeleton);
  if (Status status = check_once(skeleton, given); !status) return status.error();
  RoleMap map = roles_from_names(skeleton, names_with(skeleton, given));
  for (const GivenRole& entry : given) {
    if (!is_role_of_many(entry.role)) {
      const Role instead = entry.role == Role::chest ? Role::spine : Role::helper;
      std::replace(map.roles.begin(), map.roles.end(), entry.role, instead);
    }
    if (entry.finger.finger == Finger::none) continue;
    for (std::size_t j = 0; j < map.roles.size(); ++j) {
      if (map.roles[j] == entry.role && map.fingers[j] == entry.finger) map.fingers[j] = {};
    }
  }
  map.given.assign(map.roles.size(), 0);
  for (const GivenRole& entry : given) {
    map.given[at(entry.joint)] = 1;
    map.roles[at(entry.joint)] = entry.role;
    map.fingers[at(entry.joint)] = entry.finger;
  }
  if (Status status = check_order(skeleton, map, given); !status) return status.error();
  map.humanoid = missing_roles(map).empty();
  return map;
}

}  // namespace krok
