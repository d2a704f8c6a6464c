#include "roles/body_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok {

namespace {

constexpr double kNearAxes = 30 * kRadiansPerDegree;

// The axis, with its sign, nearest to a direction; not `taken`.
Vec3 nearest_axis(const Vec3& direction, const Vec3& taken = Vec3::Zero()) {
  Eigen::Index largest = 0;
  const Vec3 sizes = direction.cwiseAbs().cwiseProduct(Vec3::Ones() - taken.cwiseAbs());
  sizes.maxCoeff(&largest);
  return Vec3::Unit(largest) * std::copysign(1.0, direction[largest]);
}

Quat frame_of(const Vec3& left, const Vec3& up) {
  Mat3 axes;
  axes << left, up, left.cross(up);
  return Quat(axes).normalized();
}

// Left and up of a body with its joints at these places; nothing where it has no width or height.
struct BodyAxes {
  Vec3 left, up;
};
template <typename Place>
std::optional<BodyAxes> axes_of(const RoleMap& roles, const Place& place) {
  const auto has = [&](Role role) { return roles.joint(role) >= 0; };
  Vec3 left = Vec3::Zero();
  for (const auto& [of_left, of_right] : {std::pair(Role::left_upper_leg, Role::right_upper_leg),
                                          std::pair(Role::left_upper_arm, Role::right_upper_arm)}) {
    if (has(of_left) && has(of_right)) left += place(of_left) - place(of_right);
  }
  const Role top = has(Role::head) ? Role::head : has(Role::neck) ? Role::neck : Role::chest;
  if (!has(Role::hips) || !has(top)) return {};
  Vec3 up = place(top) - place(Role::hips);
  const double height = up.norm();
  if (!(height > 0) || !(left.norm() > 0.01 * height)) return {};
  left.normalize();
  up -= up.dot(left) * left;
  if (!(up.norm() > 0.1 * height)) return {};
  return BodyAxes{left, up.normalized()};
}

// The nearest rotation that takes axes to axes, where it is near.
Quat along_axes(const Quat& rotation) {
  const Vec3 up = nearest_axis(rotation * Vec3::UnitY());
  const Quat near = frame_of(nearest_axis(rotation * Vec3::UnitX(), up), up);
  return angle_between(rotation, near) <= kNearAxes ? near : rotation;
}

}  // namespace

Quat body_frame(const Skeleton& skeleton, const RoleMap& roles) {
  const auto axes = axes_of(
      roles, [&](Role role) -> Vec3 { return skeleton.reference[at(roles.joint(role))].position; });
  return axes ? along_axes(frame_of(axes->left, axes->up)) : Quat::Identity();
}

double front_of(const Skeleton& skeleton, const RoleMap& roles) {
  const Quat frame = body_frame(skeleton, roles);
  if ((frame * Vec3::UnitY()).y() < 0.7) return 0;
  const Vec3 ahead = frame * Vec3::UnitZ();
  return std::atan2(ahead.x(), ahead.z());
}

std::optional<double> heading_of(const RoleMap& roles, std::span<const Transform> joints) {
  constexpr double kLevel = 0.3;  // of the direction ahead; else it is of a body that lies
  const auto axes =
      axes_of(roles, [&](Role role) -> Vec3 { return joints[at(roles.joint(role))].position; });
  if (!axes) return {};
  const Vec3 ahead = axes->left.cross(axes->up);
  if (std::hypot(ahead.x(), ahead.z()) < kLevel) return {};
  return std::atan2(ahead.x(), ahead.z());
}

Skeleton facing_skeleton(const Clip& clip, const RoleMap& roles) {
  constexpr double kOtherwise = 45 * kRadiansPerDegree;
  constexpr int kSamples = 200;
  Skeleton skeleton = clip.skeleton;
  const Quat body = body_frame(skeleton, roles);
  const int step = std::max(1, clip.frame_count() / kSamples);
  for (const Role role : {Role::hips, Role::spine, Role::chest, Role::neck, Role::head}) {
    for (const int joint : roles.joints(role)) {
      // From the body's axes to the joint's own, on the average.
      const Quat rest = skeleton.reference[at(joint)].orientation.normalized().conjugate() * body;
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      std::optional<Quat> first;
      for (int f = 0; f < clip.frame_count(); f += step) {
        const auto axes = axes_of(roles, [&](Role of) -> Vec3 {
          return clip.frame_positions(f)[at(roles.joint(of))].cast<double>();
        });
        if (!axes) continue;
        const Quat now =
            clip.frame_orientations(f)[at(joint)].cast<double>().normalized().conjugate() *
            frame_of(axes->left, axes->up);
        if (!first) first = now;
        sum += in_hemisphere_of(*first, now).coeffs();
      }
      if (!(sum.norm() > 0)) continue;
      Quat mean;
      mean.coeffs() = sum.normalized();
      if (angle_between(mean, rest) <= kOtherwise) continue;
      const Quat other = rest * along_axes(rest.conjugate() * mean);
      skeleton.reference[at(joint)].orientation = (body * other.conjugate()).normalized();
    }
  }
  return skeleton;
}

namespace {

// Sum of bone lengths from `top` down to `joint`; 0 if either is missing or `joint` is not below
// `top`.
double path_length(const Skeleton& skeleton, std::span<const Vec3> pose, int top, int joint) {
  double length = 0;
  if (top < 0) return 0;
  while (joint >= 0 && joint != top) {
    const int parent = skeleton.parents[at(joint)];
    if (parent >= 0) length += (pose[at(joint)] - pose[at(parent)]).norm();
    joint = parent;
  }
  return joint == top && std::isfinite(length) ? length : 0;
}

}  // namespace

std::optional<Stature> stature_of(const Skeleton& skeleton, const RoleMap& roles,
                                  std::span<const Vec3> pose) {
  constexpr double kLeg = 0.49, kArm = 0.33, kSpine = 0.37, kVariation = 0.1;
  const auto path = [&](Role top, Role end) {
    return path_length(skeleton, pose, roles.joint(top), roles.joint(end));
  };
  const auto mean = [](double a, double b) {
    return a > 0 && b > 0 ? 0.5 * (a + b) : std::max(a, b);
  };
  const double leg = mean(path(Role::left_upper_leg, Role::left_foot),
                          path(Role::right_upper_leg, Role::right_foot));
  const double arm = mean(path(Role::left_upper_arm, Role::left_hand),
                          path(Role::right_upper_arm, Role::right_hand));
  const double spine = path(Role::hips, Role::head);
  Stature result;
  if (leg > 0 && spine > 0) {
    result.metres = (leg + spine) / (kLeg + kSpine);
  } else {
    result.metres = leg > 0 ? leg / kLeg : arm / kArm;
  }
  if (!(result.metres > 0)) return std::nullopt;
  std::vector<double> estimates;
  if (leg > 0) estimates.push_back(leg / kLeg);
  if (spine > 0 && leg > 0) estimates.push_back(spine / kSpine);
  if (arm > 0) estimates.push_back(arm / kArm);
  if (estimates.size() == 1) result.uncertainty = kVariation * result.metres;
  for (const double estimate : estimates) {
    result.uncertainty = std::max(result.uncertainty, std::abs(estimate - result.metres));
  }
  return result;
}

std::optional<Stature> stature_of(const Skeleton& skeleton, const RoleMap& roles) {
  std::vector<Vec3> pose;
  for (const Transform& joint : skeleton.reference) pose.push_back(joint.position);
  return stature_of(skeleton, roles, pose);
}

}  // namespace krok
