#include "scene/roles.h"

#include <array>

namespace krok {

namespace {

constexpr std::array<std::string_view, 27> kRoleNames = {
    "none",           "root",           "hips",            "spine",
    "chest",          "neck",           "head",            "left_collar",
    "left_upper_arm", "left_lower_arm", "left_hand",       "left_fingers",
    "right_collar",   "right_upper_arm", "right_lower_arm", "right_hand",
    "right_fingers",  "left_upper_leg", "left_lower_leg",  "left_foot",
    "left_toes",      "right_upper_leg", "right_lower_leg", "right_foot",
    "right_toes",     "end",            "helper"};
static_assert(kRoleNames.size() == static_cast<std::size_t>(Role::helper) + 1);

}  // namespace

std::string_view role_name(Role role) { return kRoleNames[static_cast<std::size_t>(role)]; }

int RoleMap::joint(Role role) const {
  for (std::size_t i = 0; i < roles.size(); ++i) {
    if (roles[i] == role) return static_cast<int>(i);
  }
  return -1;
}

RoleMap find_roles(const Skeleton& skeleton) {
  RoleMap map;
  map.roles.assign(skeleton.names.size(), Role::none);
  return map;
}

}  // namespace krok
