#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "core/index.h"
#include "math/transform.h"
#include "retarget/joint_mapping.h"
#include "retarget/pose_alignment.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/skeleton.h"

// Skeleton measurements shared by the parts of retargeting.

namespace krok::retarget {

inline const Vec3 kUp = Vec3::UnitY();

// The horizontal part.
inline Vec3 flat(const Vec3& v) {
  return {v.x(), 0, v.z()};
}

// 0 up to `from`, 1 beyond `to`, 3t^2 - 2t^3 between them.
inline double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// Metres between two joints in the reference pose; 0 if either is -1.
double length_of(const Skeleton& skeleton, int from, int to);

// Mean length of thigh and shank of both legs, metres; bones without a role count as 0.
double leg_length(const Skeleton& skeleton, const RoleMap& roles);

// Total length of the bones that both skeletons have, target over source, for a mapping by names; 1
// if they share none.
double bone_ratio(const Skeleton& source, const Skeleton& target, const JointMapping& mapping);

// Whether no finger of a hand ever rotates relative to the palm by more than half a degree from
// `rest`, shape [joints]. False for a hand without fingers.
bool fingers_never_move(const Clip& source, const RoleMap& roles, std::span<const Transform> rest,
                        Role hand, Role fingers);

// The directions of an actor's trunk, limbs and hands in its pose. The actor must outlive it.
class ActorView {
 public:
  explicit ActorView(const Actor& actor) : actor_(actor), children_(actor.skeleton.children()) {}

  const RoleMap& roles() const { return actor_.roles; }
  const Skeleton& skeleton() const { return actor_.skeleton; }
  int joint(Role role) const { return actor_.roles.joint(role); }
  Vec3 place(int joint) const { return actor_.pose[at(joint)].position; }
  const Quat& orientation(int joint) const { return actor_.pose[at(joint)].orientation; }

  // The unit direction between two joints; empty if either is missing or they coincide.
  std::optional<Vec3> direction(int from, int to) const;

  Vec3 middle(int a, int b) const;

  // The direction to the character's left, from the legs or the arms.
  std::optional<Vec3> left(Role left_role, Role right_role) const;

  int neck() const;

  std::optional<Vec3> hips_up() const;

  std::optional<Vec3> chest_up() const;

  // From the middle of the ankles to that of the hips' sides.
  std::optional<Vec3> legs_up() const;

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

// A T-pose of a humanoid whose reference pose does not stand (rigs whose bones all lie along one
// axis), shape [joints], facing +Z: legs down, arms to the sides, soles on the ground. It belongs
// to the skeleton and not to a motion of it: bones are turned by their directions, the turn about a
// bone by the side on which knees and elbows bend in the whole motion. Spine, head, hands and feet
// are turned as in the reference pose, or by the quarter turns from it that are nearest to the
// motion's mean. Only bone lengths and the pitch of the feet on the ground are measured. Joints
// whose roles are missing keep their place. Without `limbs` the body is only turned upright as a
// whole. Where a motion begins with a T-pose, as some exporters have it, that is the stance.
std::vector<Transform> build_stance(const Clip& clip, const RoleMap& roles, bool limbs);
// The same from a reference pose that is a frame of a motion, at its place and above its ground.
std::vector<Transform> build_stance_from_frame(const Clip& clip, const RoleMap& roles);
// build_stance() looks at every so many of a take's frames.
int step_in_take(int frames);

// Whether limbs are straight in the first frame, legs down and arms to the sides.
bool begins_in_a_stance(const Clip& clip, const RoleMap& roles);

}  // namespace krok::retarget
