#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "roles/fingers.h"
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

// The inverse of role_name; nothing for other texts.
std::optional<Role> parse_role(std::string_view name);

// Whether several joints may have a role: spine, neck, fingers, toes, root, end and the like.
bool is_role_of_many(Role role);

struct RoleMap {
  std::vector<Role> roles;           // [joints]
  std::vector<FingerJoint> fingers;  // [joints], set for left_fingers and right_fingers

  // True where hips, head or neck, both upper legs, lower legs and feet, and both upper arms and
  // hands were found: a figure that limb-wise operations can rely on.
  bool humanoid = false;

  // [joints], 1 where the user said what the joint is; empty where nothing was said.
  std::vector<std::uint8_t> given;

  // The first joint with a role, or -1. For roles that many joints have (spine, neck, fingers), no
  // other of them stands above it.
  int joint(Role role) const;

  // All joints with a role, parents first.
  std::vector<int> joints(Role role) const;

  // The joint of one phalanx of the hand whose fingers' role is `fingers`, or -1.
  int finger_joint(Role fingers, FingerJoint place) const;
};

// What a joint is, as one word: "left_upper_arm", for a joint of a finger "left_index_1", for other
// joints beyond the wrist "left_fingers".
std::string role_label(const RoleMap& map, int joint);

// The roles that a humanoid must have and this figure has not, in the order of Role. Where neither
// head nor neck was found, that is Role::head.
std::vector<Role> missing_roles(const RoleMap& map);

// The roles of a skeleton's joints, from names (of iPi, CMU, MotionBuilder, Mixamo, Xsens, Rokoko,
// OptiTrack, Perception Neuron, iClone, Daz, Biovision, Poser and Second Life, MakeHuman, Biped,
// Unreal; prefixes and name spaces are ignored) checked against the structure: a hand must hang
// under an arm, an arm under the trunk; hips are what legs and spine meet in, unless a joint above
// is named so. Where no name is known, from the shape of the reference pose, if that is safe.
// Joints that it cannot place get Role::none, as all do (end sites apart) where no limb was found.
// Never fails. The skeleton must pass check(), except that its unit and axes do not matter.
RoleMap find_roles(const Skeleton& skeleton);

// What the user says of a joint.
struct GivenRole {
  int joint = 0;
  Role role = Role::none;
  FingerJoint finger;  // for left_fingers and right_fingers, where it is known
};

// "left_hand", "left_index_1": what role_label gives, the joint left out. Nothing for other texts.
std::optional<GivenRole> parse_role_label(std::string_view label);

// The roles where some are given. What is given holds; the rest is found around it as above, so
// that a hand and an upper arm are enough for a whole arm. A joint that was found for a role that
// another one was given, and that one joint alone can have, loses it. `given` must name each joint
// once at most. Errors: role-twice (two joints were given a role that one alone can have),
// role-order (a joint was given a role whose joint must hang under that of another one, and does
// not).
Result<RoleMap> find_roles(const Skeleton& skeleton, std::span<const GivenRole> given);

}  // namespace krok
