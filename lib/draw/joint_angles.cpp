#include "draw/joint_angles.h"

#include <cmath>
#include <limits>

#include "retarget/pose_alignment.h"
#include "retarget/stance.h"

namespace krok::draw {

namespace {

// The sine of 15 degrees: for a thigh closer to the line between the hips, the direction in the
// sagittal plane is noise.
constexpr double kMinInPlane = 0.2588;
constexpr double kMaxExtended =
    -120;  // degrees; lower limit of the hip range, beyond what any hip extends
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double degrees(double radians) {
  return radians / kRadiansPerDegree;
}

Vec3 position(const Clip& clip, int frame, int joint) {
  return clip.frame_positions(frame)[static_cast<std::size_t>(joint)].cast<double>();
}

Quat orientation(const Clip& clip, int frame, int joint) {
  return normalized_or_identity(
      clip.frame_orientations(frame)[static_cast<std::size_t>(joint)].cast<double>());
}

// Angle between two directions, in degrees.
double between(const Vec3& a, const Vec3& b) {
  if (a.isZero(0) || b.isZero(0)) return kNone;
  const Vec3 u = a.stableNormalized(), v = b.stableNormalized();
  return degrees(std::atan2(u.cross(v).norm(), u.dot(v)));
}

// The joints used for the angles of one side; -1 if missing.
struct Limbs {
  int upper_leg, lower_leg, foot, upper_arm, lower_arm, hand;
};

Limbs limbs_of(const RoleMap& roles, Side side) {
  const std::size_t of = side == Side::left ? 0 : 1;
  const LegRoles& leg = kLegRoles[of];
  const ArmRoles& arm = kArmRoles[of];
  return {roles.joint(leg.upper), roles.joint(leg.lower), roles.joint(leg.foot),
          roles.joint(arm.upper), roles.joint(arm.lower), roles.joint(arm.hand)};
}

// Hips and shoulders, for the axes of the trunk.
struct Trunk {
  Limbs left, right;

  bool known() const {
    return left.upper_leg >= 0 && right.upper_leg >= 0 && left.upper_arm >= 0 &&
           right.upper_arm >= 0;
  }
  Vec3 to_left(const Clip& clip, int frame) const {
    return position(clip, frame, left.upper_leg) - position(clip, frame, right.upper_leg);
  }
  Vec3 up(const Clip& clip, int frame) const {
    return (position(clip, frame, left.upper_arm) + position(clip, frame, right.upper_arm) -
            position(clip, frame, left.upper_leg) - position(clip, frame, right.upper_leg)) /
           2;
  }
};

// The angle at the middle one of three joints, 0 if they are collinear.
std::vector<double> bend(const Clip& clip, int above, int middle, int below,
                         const FrameRange& frames) {
  std::vector<double> angles;
  if (above < 0 || middle < 0 || below < 0) return angles;
  for (int f = frames.first; f <= frames.last; ++f) {
    const Vec3 centre = position(clip, f, middle);
    angles.push_back(between(centre - position(clip, f, above), position(clip, f, below) - centre));
  }
  return angles;
}

std::vector<double> hip_flexion(const Clip& clip, const Trunk& trunk, const Limbs& limbs,
                                const FrameRange& frames) {
  std::vector<double> angles;
  if (!trunk.known() || limbs.lower_leg < 0) return angles;
  for (int f = frames.first; f <= frames.last; ++f) {
    const Vec3 left = trunk.to_left(clip, f).stableNormalized();
    const Vec3 upright = trunk.up(clip, f);
    const Vec3 up = (upright - left * left.dot(upright)).stableNormalized();
    const Vec3 thigh = position(clip, f, limbs.lower_leg) - position(clip, f, limbs.upper_leg);
    const double forward = left.cross(up).dot(thigh), down = -up.dot(thigh);
    const bool sideways = !(std::hypot(forward, down) > kMinInPlane * thigh.norm());
    const double angle = degrees(std::atan2(forward, down));
    angles.push_back(sideways ? kNone : angle < kMaxExtended ? angle + 360 : angle);
  }
  return angles;
}

std::vector<double> shoulder_elevation(const Clip& clip, const Trunk& trunk, const Limbs& limbs,
                                       const FrameRange& frames) {
  std::vector<double> angles;
  if (!trunk.known() || limbs.lower_arm < 0) return angles;
  for (int f = frames.first; f <= frames.last; ++f) {
    angles.push_back(between(-trunk.up(clip, f), position(clip, f, limbs.lower_arm) -
                                                     position(clip, f, limbs.upper_arm)));
  }
  return angles;
}

// The direction of the sole in the ankle's frame; zero if unknown.
Vec3 sole_direction(const Clip& clip, const RoleMap& roles, Side side) {
  const Role foot = side == Side::left ? Role::left_foot : Role::right_foot;
  const int ankle = roles.joint(foot);
  const int front = retarget::foot_front(clip.skeleton, roles, foot);
  const auto stance = retarget::find_stance(clip, roles, std::nullopt);
  if (ankle < 0 || front < 0 || !stance) return Vec3::Zero();
  const Transform& at_ankle = stance->pose[static_cast<std::size_t>(ankle)];
  Vec3 ahead = stance->pose[static_cast<std::size_t>(front)].position - at_ankle.position;
  ahead.y() = 0;
  return at_ankle.orientation.conjugate() * ahead;
}

std::vector<double> ankle_dorsiflexion(const Clip& clip, const RoleMap& roles, Side side,
                                       const Limbs& limbs, const FrameRange& frames,
                                       const Soles* soles) {
  std::vector<double> angles;
  if (limbs.lower_leg < 0 || limbs.foot < 0) return angles;
  const Vec3 sole = soles == nullptr     ? sole_direction(clip, roles, side)
                    : side == Side::left ? soles->left
                                         : soles->right;
  if (sole.isZero(1e-6)) return angles;
  for (int f = frames.first; f <= frames.last; ++f) {
    const Vec3 shank = position(clip, f, limbs.lower_leg) - position(clip, f, limbs.foot);
    angles.push_back(90 - between(shank, orientation(clip, f, limbs.foot) * sole));
  }
  return angles;
}

// Inverse of joint_to_parent in the reference pose, times joint_to_parent in a frame.
Quat turn_from_reference(const Clip& clip, int joint, int frame) {
  const int parent = clip.skeleton.parents[static_cast<std::size_t>(joint)];
  Quat local = orientation(clip, frame, joint);
  if (parent >= 0) local = orientation(clip, frame, parent).conjugate() * local;
  return clip.skeleton.reference_local(joint).orientation.conjugate() * local;
}

}  // namespace

std::vector<double> body_angle(const Clip& clip, const RoleMap& roles, BodyAngle angle, Side side,
                               const FrameRange& frames, const Soles* soles) {
  const Limbs limbs = limbs_of(roles, side);
  const Trunk trunk = {limbs_of(roles, Side::left), limbs_of(roles, Side::right)};
  switch (angle) {
    case BodyAngle::hip:
      return hip_flexion(clip, trunk, limbs, frames);
    case BodyAngle::knee:
      return bend(clip, limbs.upper_leg, limbs.lower_leg, limbs.foot, frames);
    case BodyAngle::ankle:
      return ankle_dorsiflexion(clip, roles, side, limbs, frames, soles);
    case BodyAngle::shoulder:
      return shoulder_elevation(clip, trunk, limbs, frames);
    case BodyAngle::elbow:
      return bend(clip, limbs.upper_arm, limbs.lower_arm, limbs.hand, frames);
  }
  return {};
}

Soles find_soles(const Clip& clip, const RoleMap& roles) {
  return {sole_direction(clip, roles, Side::left), sole_direction(clip, roles, Side::right)};
}

std::vector<double> turn_angle(const Clip& clip, int joint, const FrameRange& frames) {
  std::vector<double> angles;
  for (int f = frames.first; f <= frames.last; ++f) {
    angles.push_back(degrees(angle_between(Quat::Identity(), turn_from_reference(clip, joint, f))));
  }
  return angles;
}

std::vector<std::vector<double>> euler_angles(const Clip& clip, int joint, const EulerOrder& order,
                                              const FrameRange& frames) {
  std::vector<std::vector<double>> angles(3);
  std::optional<Vec3> before;
  for (int f = frames.first; f <= frames.last; ++f) {
    Vec3 euler = to_euler(turn_from_reference(clip, joint, f), order, before ? before->z() : 0.0);
    if (before) euler = closest_euler(euler, *before);
    before = euler;
    for (int axis = 0; axis < 3; ++axis) {
      angles[static_cast<std::size_t>(axis)].push_back(degrees(euler[axis]));
    }
  }
  return angles;
}

}  // namespace krok::draw
