#include "retarget/actor_measure_internal.h"

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

}  // namespace krok::retarget
