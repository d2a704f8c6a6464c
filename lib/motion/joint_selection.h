#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/skeleton.h"

namespace krok {

// Which joints an operation concerns, as people name them.
struct JointSelection {
  std::vector<std::string> patterns;  // names; * stands for any characters, ? for one
  std::vector<std::string> below;     // joints by name, each with all joints below it
};

// 1 for every joint that a pattern or a sub-tree selects, shape [joints]; all 1 where both lists
// are empty. Code motion-joint for a pattern or name that no joint has.
Result<std::vector<std::uint8_t>> select_joints(const Skeleton& skeleton,
                                                const JointSelection& selection);

}  // namespace krok
