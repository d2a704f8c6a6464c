#pragma once

#include <string_view>
#include <vector>

#include "scene/skeleton.h"

namespace krok {

// What a joint is to a body, whatever the exporter calls it. The joint of a role is the one whose
// rotation moves that part: left_upper_arm is at the shoulder, left_hand at the wrist, left_toes at
// the ball of the foot.
enum class Role : unsigned char {
  none,
  root,  // a joint above the hips that only places the figure
  hips,
  spine,  // every joint between hips and chest
  chest,  // the joint that the neck and the collar bones hang on
  neck,
  head,
  left_collar,
  left_upper_arm,
  left_lower_arm,
  left_hand,
  left_fingers,  // every joint beyond the wrist
  right_collar,
  right_upper_arm,
  right_lower_arm,
  right_hand,
  right_fingers,
  left_upper_leg,
  left_lower_leg,
  left_foot,
  left_toes,  // every joint beyond the ankle, the heel apart
  right_upper_leg,
  right_lower_leg,
  right_foot,
  right_toes,
  end,    // an end site
  helper  // a joint that no limb needs: twist joints, hip bones of length 0, props, face
};

// "left_upper_arm".
std::string_view role_name(Role role);

struct RoleMap {
  std::vector<Role> roles;  // [joints]

  // True where hips, head or neck, both upper legs, lower legs and feet, and both upper arms and
  // hands were found: a figure that limb-wise operations can rely on.
  bool humanoid = false;

  // The first joint with a role, or -1. For roles that many joints have (spine, neck, fingers), no
  // other of them stands above it.
  int joint(Role role) const;
};

// The roles of a skeleton's joints, from names (of iPi, CMU, MotionBuilder, Mixamo, Xsens, Rokoko,
// OptiTrack, Perception Neuron, iClone, Daz, Biovision, Poser and Second Life, MakeHuman, Biped,
// Unreal; prefixes and name spaces are ignored) checked against the structure: a hand must hang
// under an arm, an arm under the trunk; hips are what legs and spine meet in, unless a joint above
// is named so. Where no name is known, from the shape of the reference pose, if that is safe.
// Joints that it cannot place get Role::none, as all do (end sites apart) where no limb was found.
// Never fails. The skeleton must pass check(), except that its unit and axes do not matter.
RoleMap find_roles(const Skeleton& skeleton);

}  // namespace krok
