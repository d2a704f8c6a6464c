#include "roles/stature.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"

namespace krok {

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
