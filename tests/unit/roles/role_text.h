#pragma once

#include <string>

#include "roles/roles.h"

namespace krok::test {

// The joint that has a role, or "-".
inline std::string joint_name(const Skeleton& skeleton, const RoleMap& map, Role role) {
  const int joint = map.joint(role);
  return joint < 0 ? "-" : skeleton.names[static_cast<std::size_t>(joint)];
}

// For a failing test: all joints with their roles.
inline std::string table(const Skeleton& skeleton, const RoleMap& map) {
  std::string text;
  for (std::size_t j = 0; j < map.roles.size(); ++j) {
    text += "  " + skeleton.names[j] + ": " + std::string(role_name(map.roles[j])) + "\n";
  }
  return text;
}

}  // namespace krok::test
