#include "retarget/actor_view_internal.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok::retarget {

double length_of(const Skeleton& skeleton, int from, int to) {
  if (from < 0 || to < 0) return 0;
  return (skeleton.reference[at(from)].position - skeleton.reference[at(to)].position).norm();
}

double leg_length(const Skeleton& skeleton, const RoleMap& roles) {
  const auto one = [&](Role upper, Role lower, Role foot) {
    return length_of(skeleton, roles.joint(upper), roles.joint(lower)) +
           length_of(skeleton, roles.joint(lower), roles.joint(foot));
  };
  return 0.5 * (one(Role::left_upper_leg, Role::left_lower_leg, Role::left_foot) +
                one(Role::right_upper_leg, Role::right_lower_leg, Role::right_foot));
}

double bone_ratio(const Skeleton& source, const Skeleton& target, const JointMapping& mapping) {
  double from = 0;
  double to = 0;
  for (int k = 1; k < target.joint_count(); ++k) {
    const int parent = target.parents[at(k)];
    const int source_joint = mapping[at(k)].first;
    if (source_joint < 0 || mapping[at(parent)].first < 0) continue;
    from += length_of(source, source_joint, mapping[at(parent)].first);
    to += length_of(target, k, parent);
  }
  return from > 0 && to > 0 ? to / from : 1.0;
}

bool fingers_never_move(const Clip& source, const RoleMap& roles, std::span<const Transform> rest,
                        Role hand, Role fingers) {
  constexpr double kStill = 0.5 * kRadiansPerDegree;
  const int palm = palm_joint(source.skeleton, roles, hand);
  std::vector<int> joints;
  for (const int joint : roles.joints(fingers)) {
    const FingerJoint place = roles.fingers[at(joint)];
    const bool moves =
        place.finger != Finger::none && place.phalanx >= 1 && place.phalanx < FingerJoint::kTip;
    if (moves && joint != palm) joints.push_back(joint);
  }
  if (palm < 0 || joints.empty()) return false;
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    const auto orientations = source.frame_orientations(frame);
    const Quat turn =
        orientations[at(palm)].cast<double>().normalized() * rest[at(palm)].orientation.conjugate();
    for (const int joint : joints) {
      const Quat carried = turn * rest[at(joint)].orientation;
      const Quat now = orientations[at(joint)].cast<double>().normalized();
      if (angle_between(carried, now) > kStill) return false;
    }
  }
  return true;
}

std::optional<Vec3> ActorView::direction(int from, int to) const {
  if (from < 0 || to < 0) return std::nullopt;
  const Vec3 along = place(to) - place(from);
  const double length = along.norm();
  if (!(length > 1e-9)) return std::nullopt;
  return Vec3(along / length);
}

Vec3 ActorView::middle(int a, int b) const {
  if (a < 0 || b < 0) return place(std::max(a, b));
  return 0.5 * (place(a) + place(b));
}

std::optional<Vec3> ActorView::left(Role left_role, Role right_role) const {
  return direction(joint(right_role), joint(left_role));
}

int ActorView::neck() const {
  const int neck = joint(Role::neck);
  return neck >= 0 ? neck : joint(Role::head);
}

std::optional<Vec3> ActorView::hips_up() const {
  const int chest = joint(Role::chest);
  const int top = chest >= 0 ? chest : neck();
  if (top < 0) return std::nullopt;
  const Vec3 along = place(top) - middle(joint(Role::left_upper_leg), joint(Role::right_upper_leg));
  return along.norm() > 1e-9 ? std::optional<Vec3>(along.normalized()) : std::nullopt;
}

std::optional<Vec3> ActorView::chest_up() const {
  const int chest = joint(Role::chest);
  return direction(chest >= 0 ? chest : joint(Role::hips), neck());
}

std::optional<Vec3> ActorView::legs_up() const {
  const int left = joint(Role::left_foot), right = joint(Role::right_foot);
  if (left < 0 || right < 0) return std::nullopt;
  const Vec3 along =
      middle(joint(Role::left_upper_leg), joint(Role::right_upper_leg)) - middle(left, right);
  return along.norm() > 1e-9 ? std::optional<Vec3>(along.normalized()) : std::nullopt;
}

int ActorView::only_child(int joint) const {
  int only = -1;
  for (const int child : children_[at(joint)]) {
    if (roles().roles[at(child)] == Role::helper) continue;
    if (only >= 0) return -1;
    only = child;
  }
  return only;
}

int ActorView::knuckle(Role fingers, Finger finger) const {
  for (const int phalanx : {1, FingerJoint::kMetacarpal}) {
    const int joint = roles().finger_joint(fingers, {finger, phalanx});
    if (joint >= 0) return joint;
  }
  return -1;
}

std::optional<Vec3> ActorView::hand_direction(const ArmRoles& arm) const {
  const int wrist = joint(arm.hand);
  if (wrist < 0) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const Finger finger : {Finger::index, Finger::middle, Finger::ring, Finger::little}) {
    const int found = knuckle(arm.fingers, finger);
    if (found < 0) continue;
    sum += place(found) - place(wrist);
    ++count;
  }
  if (count > 0 && sum.norm() > 1e-9) return Vec3(sum.normalized());
  const auto forearm = direction(joint(arm.lower), wrist);
  for (const int child : children(wrist)) {
    if (roles().fingers[at(child)].finger == Finger::thumb) continue;
    const auto along = direction(wrist, child);
    if (along && forearm && along->dot(*forearm) > std::cos(40 * kRadiansPerDegree)) return along;
  }
  return std::nullopt;
}

std::optional<Vec3> ActorView::knuckle_line(const ArmRoles& arm) const {
  for (const Finger outer : {Finger::little, Finger::ring}) {
    const auto line = direction(knuckle(arm.fingers, outer), knuckle(arm.fingers, Finger::index));
    if (line) return line;
  }
  return std::nullopt;
}

std::optional<Vec3> ActorView::thumb_line(const ArmRoles& arm) const {
  const int wrist = joint(arm.hand);
  int last = -1;
  for (const int phalanx : {1, 2, 3}) {
    const int found = roles().finger_joint(arm.fingers, {Finger::thumb, phalanx});
    if (found >= 0) last = found;
  }
  return direction(wrist, last);
}

}  // namespace krok::retarget
