#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/skeleton.h"

namespace krok {

// The joints that an operation applies to, selected by name.
struct JointSelection {
  // Names; * matches any characters, ? one. A name that no joint has may be a role (see
  // parse_role).
  std::vector<std::string> patterns;
  std::vector<std::string> below;  // joint names or roles; each selects its subtree
};

// 1 for each joint selected by a pattern or subtree, shape [joints]; all 1 if both lists are empty.
// Code motion-joint if a pattern or name matches no joint.
Result<std::vector<std::uint8_t>> select_joints(const Skeleton& skeleton,
                                                const JointSelection& selection);

}  // namespace krok
