#pragma once

#include <array>
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

// The anatomical role of a joint, independent of its name. The joint of a role is the one whose
// rotation moves that part: left_upper_arm is at the shoulder, left_hand at the wrist, left_toes at
// the ball of the foot.
enum class Role : unsigned char {
  none,
  root,  // a joint above the hips that only positions the character
  hips,
  spine,  // every joint between hips and chest
  chest,  // the parent of neck and collar bones
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
  left_toes,  // every joint beyond the ankle, except the heel
  right_upper_leg,
  right_lower_leg,
  right_foot,
  right_toes,
  end,    // an end site
  helper  // moves no limb: twist joints, hip bones of length 0, props, face
};

// "left_upper_arm".
std::string_view role_name(Role role);

// The inverse of role_name, whatever its case and without its underscores, too; knee, elbow, wrist,
// ankle, hip and shoulder are the joints there: RightHand is right_hand, left knee left_lower_leg.
// Empty for other text.
std::optional<Role> parse_role(std::string_view name);

// Whether several joints may have the role: none, root, spine, neck, fingers, toes, end, helper.
bool is_role_of_many(Role role);

struct RoleMap {
  std::vector<Role> roles;           // [joints]
  std::vector<FingerJoint> fingers;  // [joints], set for left_fingers and right_fingers

  // True if hips, head or neck, both upper legs, lower legs and feet, and both upper arms and hands
  // were found, as operations on limbs require.
  bool humanoid = false;

  // [joints], 1 if the user gave the joint's role; empty if no roles were given.
  std::vector<std::uint8_t> given;

  // The first joint with the role, or -1. For roles of several joints (spine, neck, fingers), it is
  // not a descendant of another one.
  int joint(Role role) const;

  // All joints with the role, parents first.
  std::vector<int> joints(Role role) const;

  // The joint of one phalanx, or -1. `fingers`: left_fingers or right_fingers.
  int finger_joint(Role fingers, FingerJoint place) const;
};

// A joint's role as one word: "left_upper_arm"; for finger joints "left_index_1"; for other joints
// beyond the wrist "left_fingers".
std::string role_label(const RoleMap& map, int joint);

// A joint by its exact name, otherwise the first one of the role that parse_role reads; -1 for
// none.
int find_joint(const Skeleton& skeleton, const RoleMap& roles, std::string_view name);

// The roles required for a humanoid that were not found, in the order of Role. Role::head means
// that neither head nor neck was found.
std::vector<Role> missing_roles(const RoleMap& map);

// Detects the roles of a skeleton's joints from their names (iPi, CMU, MotionBuilder, Mixamo,
// Xsens, Rokoko, OptiTrack, Perception Neuron, iClone, Daz, Biovision, Poser and Second Life,
// MakeHuman, Biped, Unreal, MMD; prefixes and namespaces are ignored), checked against the
// hierarchy: a hand must descend from an arm, an arm from the trunk; the hips are where legs and
// spine meet, unless a joint above is named hips. If the names give no whole body, roles come from
// the shape of the reference pose, provided that it is clearly humanoid and no limb's name
// contradicts it. Unidentified joints get Role::none; without any limb all joints do, except end
// sites. Never fails. The skeleton must pass check(), but may
// have any unit and axes.
RoleMap find_roles(const Skeleton& skeleton);

// A role that the user gave to a joint.
struct GivenRole {
  int joint = 0;
  Role role = Role::none;
  FingerJoint finger;  // for left_fingers and right_fingers, if known
};

// The inverse of role_label ("left_hand", "left_index_1"), with joint 0; empty for other text.
std::optional<GivenRole> parse_role_label(std::string_view label);

// As above, with some roles given. Given roles take precedence; the others are detected
// consistently with them, so a hand and an upper arm suffice for a whole arm. If only one joint can
// have a role, a given joint replaces a detected one. `given` must contain each joint at most once.
// Errors: role-twice (two joints with a role that only one can have), role-order (such as a hand
// that is not a descendant of its upper arm).
Result<RoleMap> find_roles(const Skeleton& skeleton, std::span<const GivenRole> given);

// The joints that rotate the eyes; -1 if missing.
struct EyeJoints {
  int left = -1;
  int right = -1;
};

// Finds the eyes by name alone, such as "LeftEye", "eye.L", "lEye", "J_Adj_R_FaceEye": names with
// the word eye and a side, but without a word for a part around the eye or a control (lid, brow,
// lash, target, end and so on). The first match per side.
EyeJoints find_eyes(const Skeleton& skeleton);

// The roles of the joints of a limb.

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
