#include "ik/anatomical_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok::ik {

namespace {

// Degrees, for the left side. Bends are about the axis that points to the body's left (forwards is
// negative for what hangs down, positive for what stands up), tilts about the one that points
// forwards (positive takes what hangs down to the left), turns about the one that points up
// (positive is to the left).
struct Ranges {
  double bend[2], tilt[2], turn[2];
};

constexpr Ranges kHip = {{-120, 30}, {-30, 45}, {-45, 45}};
constexpr Ranges kKnee = {{-10, 135}, {-10, 10}, {-30, 40}};
constexpr Ranges kAnkle = {{-20, 50}, {-35, 15}, {-20, 20}};
constexpr Ranges kToes = {{-70, 40}, {-10, 10}, {-10, 10}};
constexpr Ranges kCollar = {{-10, 10}, {-10, 40}, {-20, 20}};
// From the middle of flexion -180 to 60 and abduction -45 to 180; see shoulder().
constexpr Ranges kShoulder = {{-120, 120}, {-112.5, 112.5}, {-90, 90}};
constexpr double kShoulderBend = -60, kShoulderTilt = 67.5;
constexpr Ranges kElbow = {{-150, 10}, {-10, 10}, {-80, 80}};
// Palms face the body where arms hang: flexion is a tilt, radial deviation a bend forwards.
constexpr Ranges kWrist = {{-20, 30}, {-80, 70}, {-80, 80}};
constexpr Ranges kKnuckle = {{-20, 20}, {-90, 45}, {-10, 10}};
constexpr Ranges kPhalanx = {{-5, 5}, {-100, 10}, {-5, 5}};
constexpr Ranges kThumb = {{-50, 50}, {-50, 50}, {-30, 30}};
constexpr Ranges kNeck = {{-45, 45}, {-45, 45}, {-60, 60}};
constexpr Ranges kSpine = {{-25, 80}, {-35, 35}, {-45, 45}};

Quat frame_of(const Vec3& left, const Vec3& up) {
  Mat3 axes;
  const Vec3 forward = left.cross(up).normalized();
  axes << up.cross(forward).normalized(), up, forward;
  return Quat(axes);
}

class Anatomy {
 public:
  Anatomy(const Skeleton& skeleton, const RoleMap& roles) : skeleton_(skeleton), roles_(roles) {
    const Vec3 hips = 0.5 * (place(Role::left_upper_leg) + place(Role::right_upper_leg));
    int top = roles.joint(Role::neck);
    if (top < 0) top = roles.joint(Role::head);
    const Vec3 up = skeleton.reference[at(top)].position - hips;
    const Vec3 left = place(Role::left_upper_leg) - place(Role::right_upper_leg);
    trunk_ = frame_of(left.normalized(), up.normalized());
  }

  bool defined() const { return trunk_.coeffs().allFinite(); }

  // The anatomical axes of a joint's part of the body in the reference pose: x to the left, y up, z
  // forwards as they are when it stands in the anatomical position.
  Quat frame(int joint) const {
    switch (roles_.roles[at(joint)]) {
      case Role::left_upper_arm:
        return along(trunk_, Role::left_upper_arm, Role::left_lower_arm);
      case Role::right_upper_arm:
        return along(trunk_, Role::right_upper_arm, Role::right_lower_arm);
      case Role::left_upper_leg:
        return along(trunk_, Role::left_upper_leg, Role::left_lower_leg);
      case Role::right_upper_leg:
        return along(trunk_, Role::right_upper_leg, Role::right_lower_leg);
      case Role::left_lower_arm:
      case Role::left_hand:
      case Role::left_fingers:
        return along(along(trunk_, Role::left_upper_arm, Role::left_lower_arm),
                     Role::left_lower_arm, Role::left_hand);
      case Role::right_lower_arm:
      case Role::right_hand:
      case Role::right_fingers:
        return along(along(trunk_, Role::right_upper_arm, Role::right_lower_arm),
                     Role::right_lower_arm, Role::right_hand);
      case Role::left_lower_leg:
        return along(along(trunk_, Role::left_upper_leg, Role::left_lower_leg),
                     Role::left_lower_leg, Role::left_foot);
      case Role::right_lower_leg:
        return along(along(trunk_, Role::right_upper_leg, Role::right_lower_leg),
                     Role::right_lower_leg, Role::right_foot);
      default:
        return trunk_;
    }
  }

  // The limb's frame above it: what the anatomical position aligns this one with.
  Quat frame_above(int joint) const {
    switch (roles_.roles[at(joint)]) {
      case Role::left_lower_arm:
        return frame(roles_.joint(Role::left_upper_arm));
      case Role::right_lower_arm:
        return frame(roles_.joint(Role::right_upper_arm));
      case Role::left_lower_leg:
        return frame(roles_.joint(Role::left_upper_leg));
      case Role::right_lower_leg:
        return frame(roles_.joint(Role::right_upper_leg));
      case Role::left_upper_arm:
      case Role::right_upper_arm:
      case Role::left_upper_leg:
      case Role::right_upper_leg:
        return trunk_;
      default:
        return frame(joint);
    }
  }

  const Quat& trunk() const { return trunk_; }

 private:
  Vec3 place(Role role) const { return skeleton_.reference[at(roles_.joint(role))].position; }

  // `above` turned by the least so that its -y is along a bone.
  Quat along(const Quat& above, Role from, Role to) const {
    if (roles_.joint(from) < 0 || roles_.joint(to) < 0) return above;
    return shortest_arc(above * Vec3(-Vec3::UnitY()), place(to) - place(from)) * above;
  }

  const Skeleton& skeleton_;
  const RoleMap& roles_;
  Quat trunk_;
};

// The ranges as a cone, mirrored for the right side, shared by `share` joints.
JointLimit cone_of(const Skeleton& skeleton, const Anatomy& anatomy, int joint,
                   const Ranges& ranges, bool right, double share) {
  const int parent = skeleton.parents[at(joint)];
  const Quat& joint_reference = skeleton.reference[at(joint)].orientation;
  const Quat& parent_reference = skeleton.reference[at(parent)].orientation;
  const Quat frame = anatomy.frame(joint);
  const double unit = kRadiansPerDegree / share;
  JointLimit limit;
  limit.kind = JointLimit::Kind::cone;
  // Where the joint's frame coincides with the one above it, carried back to joint_to_parent.
  limit.zero = (parent_reference.conjugate() * anatomy.frame_above(joint) * frame.conjugate() *
                joint_reference)
                   .normalized();
  const Quat to_joint = joint_reference.conjugate() * frame;
  limit.axis = to_joint * Vec3::UnitY();
  limit.swing_axis = to_joint * Vec3::UnitX();
  const double side = right ? -1 : 1;
  // The second swing axis, y cross x, points backwards.
  const double tilt[2] = {-side * ranges.tilt[0] * unit, -side * ranges.tilt[1] * unit};
  const double turn[2] = {side * ranges.turn[0] * unit, side * ranges.turn[1] * unit};
  limit.min_swing = {ranges.bend[0] * unit, std::min(tilt[0], tilt[1])};
  limit.max_swing = {ranges.bend[1] * unit, std::max(tilt[0], tilt[1])};
  limit.min_twist = std::min(turn[0], turn[1]);
  limit.max_twist = std::max(turn[0], turn[1]);
  return limit;
}

// The shoulder's directions lie about one that is forwards and outwards.
JointLimit shoulder(const Skeleton& skeleton, const Anatomy& anatomy, int joint, bool right) {
  JointLimit limit = cone_of(skeleton, anatomy, joint, kShoulder, right, 1);
  const Vec3 second = limit.axis.cross(limit.swing_axis);
  const double tilt = (right ? 1 : -1) * kShoulderTilt;
  limit.zero =
      (limit.zero *
       from_rotation_vector(kRadiansPerDegree * (kShoulderBend * limit.swing_axis + tilt * second)))
          .normalized();
  return limit;
}

const Ranges& finger_ranges(const FingerJoint& finger) {
  if (finger.finger == Finger::thumb) return kThumb;
  return finger.phalanx <= 1 ? kKnuckle : kPhalanx;
}

JointLimit limit_for(const Skeleton& skeleton, const RoleMap& roles, const Anatomy& anatomy,
                     int joint) {
  const auto cone = [&](const Ranges& ranges, bool right, double share = 1) {
    return cone_of(skeleton, anatomy, joint, ranges, right, share);
  };
  const auto count = [&](Role role) { return static_cast<double>(roles.joints(role).size()); };
  const Role role = roles.roles[at(joint)];
  switch (role) {
    case Role::left_upper_leg:
    case Role::right_upper_leg:
      return cone(kHip, role == Role::right_upper_leg);
    case Role::left_lower_leg:
    case Role::right_lower_leg:
      return cone(kKnee, role == Role::right_lower_leg);
    case Role::left_foot:
    case Role::right_foot:
      return cone(kAnkle, role == Role::right_foot);
    case Role::left_toes:
    case Role::right_toes:
      return cone(kToes, role == Role::right_toes);
    case Role::left_collar:
    case Role::right_collar:
      return cone(kCollar, role == Role::right_collar);
    case Role::left_upper_arm:
    case Role::right_upper_arm:
      return shoulder(skeleton, anatomy, joint, role == Role::right_upper_arm);
    case Role::left_lower_arm:
    case Role::right_lower_arm:
      return cone(kElbow, role == Role::right_lower_arm);
    case Role::left_hand:
    case Role::right_hand:
      return cone(kWrist, role == Role::right_hand);
    case Role::left_fingers:
    case Role::right_fingers:
      return cone(finger_ranges(roles.fingers[at(joint)]), role == Role::right_fingers);
    case Role::neck:
    case Role::head:
      return cone(kNeck, false, std::max(1.0, count(Role::neck) + count(Role::head)));
    case Role::spine:
    case Role::chest:
      return cone(kSpine, false, std::max(1.0, count(Role::spine) + count(Role::chest)));
    case Role::end: {
      JointLimit limit;
      limit.kind = JointLimit::Kind::locked;
      return limit;
    }
    default:
      return {};
  }
}

}  // namespace

Limits anatomical_limits(const Skeleton& skeleton, const RoleMap& roles) {
  Limits limits(skeleton.names.size());
  if (!roles.humanoid) return limits;
  const Anatomy anatomy(skeleton, roles);
  if (!anatomy.defined()) return limits;
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    limits[at(j)] = limit_for(skeleton, roles, anatomy, j);
  }
  return limits;
}

namespace {

constexpr double kCollarPart = 0.25;  // of the mass above the lowest joint of the spine
constexpr double kBody = 73;          // kilograms

// Share of the body, and where the centre is on the way from the joint to the end of its part.
struct Part {
  Role role, end;
  double share, place;
};

constexpr std::array kParts = {
    Part{Role::left_upper_arm, Role::left_lower_arm, 0.0271, 0.5772},
    Part{Role::right_upper_arm, Role::right_lower_arm, 0.0271, 0.5772},
    Part{Role::left_lower_arm, Role::left_hand, 0.0162, 0.4574},
    Part{Role::right_lower_arm, Role::right_hand, 0.0162, 0.4574},
    Part{Role::left_upper_leg, Role::left_lower_leg, 0.1416, 0.4095},
    Part{Role::right_upper_leg, Role::right_lower_leg, 0.1416, 0.4095},
    Part{Role::left_lower_leg, Role::left_foot, 0.0433, 0.4395},
    Part{Role::right_lower_leg, Role::right_foot, 0.0433, 0.4395},
};

// Parts whose centre is put at the middle of what hangs on them.
struct Lump {
  Role role;
  double share;
};
constexpr std::array kLumps = {Lump{Role::left_hand, 0.0061}, Lump{Role::right_hand, 0.0061},
                               Lump{Role::left_foot, 0.0137}, Lump{Role::right_foot, 0.0137}};
constexpr double kHead = 0.0694, kPelvis = 0.1117, kTrunk = 0.3229;

Vec3 middle_of_children(const Skeleton& skeleton, int joint) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int j = joint + 1; j < skeleton.joint_count(); ++j) {
    if (skeleton.parents[at(j)] != joint) continue;
    sum += skeleton.reference_local(j).position;
    ++count;
  }
  return count == 0 ? Vec3(Vec3::Zero()) : Vec3(0.5 / count * sum);
}

}  // namespace

BodyMasses body_masses(const Skeleton& skeleton, const RoleMap& roles) {
  BodyMasses body;
  body.masses.assign(skeleton.names.size(), 0.0);
  body.centres.assign(skeleton.names.size(), Vec3::Zero());
  if (!roles.humanoid) return body;
  for (const Part& part : kParts) {
    const int joint = roles.joint(part.role), end = roles.joint(part.end);
    if (joint < 0 || end < 0) continue;
    body.masses[at(joint)] = kBody * part.share;
    const Transform& from = skeleton.reference[at(joint)];
    body.centres[at(joint)] =
        from.inverse() *
        Vec3(from.position + part.place * (skeleton.reference[at(end)].position - from.position));
  }
  const auto put = [&](int joint, double share) {
    if (joint < 0) return;
    body.masses[at(joint)] += kBody * share;
    body.centres[at(joint)] = middle_of_children(skeleton, joint);
  };
  for (const Lump& lump : kLumps) put(roles.joint(lump.role), lump.share);
  const int head = roles.joint(Role::head);
  put(head >= 0 ? head : roles.joint(Role::neck), kHead);
  put(roles.joint(Role::hips), kPelvis);
  std::vector<int> trunk = roles.joints(Role::spine);
  for (const int joint : roles.joints(Role::chest)) trunk.push_back(joint);
  if (trunk.empty()) {
    put(roles.joint(Role::hips), kTrunk);
  } else {
    for (const int joint : trunk) put(joint, kTrunk / static_cast<double>(trunk.size()));
  }
  return body;
}

std::vector<double> trunk_stiffness(const Skeleton& skeleton, const RoleMap& roles,
                                    double whole_body) {
  std::vector<double> stiffness(skeleton.names.size(), 0.0);
  if (!roles.humanoid) return stiffness;
  std::vector<double> carried = body_masses(skeleton, roles).masses;
  for (std::size_t j = carried.size(); j-- > 1;) carried[at(skeleton.parents[j])] += carried[j];
  const int upper_arm = roles.joint(Role::left_upper_arm);
  if (upper_arm < 0) return stiffness;
  const double arm = carried[at(upper_arm)];
  std::vector<int> trunk = roles.joints(Role::spine);
  for (const int joint : roles.joints(Role::chest)) trunk.push_back(joint);
  const auto set = [&](int joint, double mass) {
    if (joint < 0 || !(mass > arm)) return;
    stiffness[at(joint)] = 1 - std::pow(arm / mass, 4 * (1 - whole_body));
  };
  double heaviest = 0;
  for (const int joint : trunk) {
    heaviest = std::max(heaviest, carried[at(joint)]);
    set(joint, carried[at(joint)] * static_cast<double>(trunk.size()));
  }
  for (const Role collar : {Role::left_collar, Role::right_collar}) {
    set(roles.joint(collar), kCollarPart * heaviest);
  }
  return stiffness;
}

}  // namespace krok::ik
