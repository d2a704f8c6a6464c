#pragma once

#include <optional>
#include <vector>

#include "core/index.h"
#include "math/types.h"
#include "retarget/pose_alignment.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok::retarget {

struct ArmRoles {
  Role collar, upper, lower, hand, fingers;
};
struct LegRoles {
  Role upper, lower, foot;
};

// The directions of an actor's trunk, limbs and hands in its pose. The actor must outlive it.
class ActorView {
 public:
  explicit ActorView(const Actor& actor) : actor_(actor), children_(actor.skeleton.children()) {}

  const RoleMap& roles() const { return actor_.roles; }
  const Skeleton& skeleton() const { return actor_.skeleton; }
  int joint(Role role) const { return actor_.roles.joint(role); }
  Vec3 place(int joint) const { return actor_.pose[at(joint)].position; }

  // The unit direction between two joints; empty if either is missing or they coincide.
  std::optional<Vec3> direction(int from, int to) const;

  Vec3 middle(int a, int b) const;

  // The direction to the character's left, from the legs or the arms.
  std::optional<Vec3> left(Role left_role, Role right_role) const;

  int neck() const;

  std::optional<Vec3> hips_up() const;

  std::optional<Vec3> chest_up() const;

  // The end of a joint's bone: its only child that is not a helper, or -1.
  int only_child(int joint) const;

  const std::vector<int>& children(int joint) const { return children_[at(joint)]; }

  // The first joint of a finger beyond the palm, otherwise its metacarpal, or -1.
  int knuckle(Role fingers, Finger finger) const;

  // From the wrist to the mean of the knuckles, or without knuckles to the end of the hand if that
  // is along the forearm.
  std::optional<Vec3> hand_direction(const ArmRoles& arm) const;

  // From the little or ring finger's knuckle to the index finger's.
  std::optional<Vec3> knuckle_line(const ArmRoles& arm) const;

  std::optional<Vec3> thumb_line(const ArmRoles& arm) const;

 private:
  const Actor& actor_;
  std::vector<std::vector<int>> children_;
};

}  // namespace krok::retarget
