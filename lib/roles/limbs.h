#pragma once

#include <array>

#include "roles/roles.h"

// The roles of the joints of a limb.

namespace krok {

struct ArmRoles {
  Role collar, upper, lower, hand, fingers;
};
struct LegRoles {
  Role upper, lower, foot, toes;
};

// The left limb, then the right one.
inline constexpr std::array<ArmRoles, 2> kArmRoles = {
    {{Role::left_collar, Role::left_upper_arm, Role::left_lower_arm, Role::left_hand,
      Role::left_fingers},
     {Role::right_collar, Role::right_upper_arm, Role::right_lower_arm, Role::right_hand,
      Role::right_fingers}}};
inline constexpr std::array<LegRoles, 2> kLegRoles = {
    {{Role::left_upper_leg, Role::left_lower_leg, Role::left_foot, Role::left_toes},
     {Role::right_upper_leg, Role::right_lower_leg, Role::right_foot, Role::right_toes}}};

}  // namespace krok
