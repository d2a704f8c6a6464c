#pragma once

#include <array>

#include "roles/named_joints_internal.h"

namespace krok {

// The joints at the ends of the limbs and the head; -1 for those that were not found.
struct LimbTips {
  std::array<int, 2> hands = {-1, -1};  // left, right
  std::array<int, 2> feet = {-1, -1};
  int head = -1;
  int neck = -1;
};

LimbTips find_limb_tips(const NamedJoints& joints);

}  // namespace krok
