#include "retarget/same_skeleton.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok::retarget {

namespace {

constexpr double kScaleTolerance = 1e-6;
constexpr double kOffsetTolerance = 1e-5;  // of the root of the sum of squared bone lengths
// Of the mean bone. Some rigs (Biped) move spine, collars and thighs in their parents: of such a
// bone's own length.
constexpr double kBoneOfPerson = 0.005, kMovedBone = 0.35;
constexpr double kAxesTolerance = 1e-4;  // radians

// With the scale of the bones, where these are the same; source_joint is given.
std::optional<SameSkeleton> with_same_bones(const Skeleton& source, const Skeleton& target,
                                            SameSkeleton same) {
  std::vector<Vec3> from, to;
  double product = 0;
  double square = 0;
  for (int k = 1; k < target.joint_count(); ++k) {
    from.push_back(source.reference_local(same.source_joint[at(k)]).position);
    to.push_back(target.reference_local(k).position);
    product += from.back().dot(to.back());
    square += from.back().squaredNorm();
  }
  if (square > 0) same.scale = product / square;
  if (!(same.scale > 0) || !std::isfinite(same.scale)) return std::nullopt;
  const double tolerance = kOffsetTolerance * same.scale * std::sqrt(square);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if ((to[i] - same.scale * from[i]).norm() > tolerance) return std::nullopt;
  }
  if (std::abs(same.scale - 1) < kScaleTolerance) same.scale = 1;
  return same;
}

// The bones of joints that both have, and whose parents both have.
struct SharedBone {
  int joint, child;  // in the target
  Vec3 from, to;     // offsets
  double twist;      // radians, of one reference rotation of the parent against the
                     // other, about the bone
};

std::vector<SharedBone> shared_bones(const Skeleton& source, const Skeleton& target,
                                     const SameSkeleton& same) {
  std::vector<SharedBone> bones;
  for (int k = 1; k < target.joint_count(); ++k) {
    const int parent = target.parents[at(k)], from = same.source_joint[at(k)];
    if (from < 0 || parent < 0 || same.source_joint[at(parent)] < 0) continue;
    SharedBone bone{parent, k, source.reference_local(from).position,
                    target.reference_local(k).position, 0};
    const Quat turn = target.reference_local(parent).orientation.conjugate() *
                      source.reference_local(same.source_joint[at(parent)]).orientation;
    const Vec3 axis = bone.to.stableNormalized();
    bone.twist = std::remainder(2 * std::atan2(turn.vec().dot(axis), turn.w()), 2 * kPi);
    bones.push_back(bone);
  }
  return bones;
}

// Fingers and what has no role, too: files that hold a pose have moved them in it.
bool may_move(Role role) {
  return role == Role::none || is_role_of_many(role) || role == Role::spine ||
         role == Role::chest || role == Role::left_collar || role == Role::right_collar ||
         role == Role::left_upper_leg || role == Role::right_upper_leg;
}

// Axes that are other ones about a bone do not show in its offset: reference poses are turned about
// it by more than postures are.
std::optional<SameSkeleton> with_bones_of_person(const std::vector<SharedBone>& bones,
                                                 const RoleMap& roles, SameSkeleton same) {
  constexpr double kMaxTwist = 75 * kRadiansPerDegree;
  double product = 0, square = 0, after = 0;
  for (const SharedBone& bone : bones) {
    product += bone.from.dot(bone.to);
    square += bone.from.squaredNorm();
    after += bone.to.norm();
  }
  same.scale = product / square;
  if (!(same.scale > 0) || !std::isfinite(same.scale)) return std::nullopt;
  const double tolerance = kBoneOfPerson * after / static_cast<double>(bones.size());
  for (const SharedBone& bone : bones) {
    const double moved = may_move(roles.roles[at(bone.child)]) ? kMovedBone * bone.to.norm() : 0;
    if ((same.scale * bone.from - bone.to).norm() > tolerance + moved) return std::nullopt;
    // A forearm that is turned so alone is one that a pose turns.
    const Role role = roles.roles[at(bone.joint)];
    const Role other = role == Role::left_lower_arm    ? Role::right_lower_arm
                       : role == Role::right_lower_arm ? Role::left_lower_arm
                                                       : role;
    const auto is_turned = [&](const SharedBone& one) {
      return roles.roles[at(one.joint)] == other && std::abs(one.twist) > kMaxTwist;
    };
    if (bone.joint > roles.joint(Role::hips) && std::abs(bone.twist) > kMaxTwist &&
        std::ranges::any_of(bones, is_turned)) {
      return std::nullopt;
    }
  }
  if (std::abs(same.scale - 1) < kBoneOfPerson) same.scale = 1;
  return same;
}

}  // namespace

bool carries(const Skeleton& skeleton, int joint, int carried) {
  while (carried > joint) carried = skeleton.parents[at(carried)];
  return carried == joint;
}

std::optional<SameSkeleton> same_skeleton(const Skeleton& source, const Skeleton& target) {
  if (source.joint_count() != target.joint_count()) return std::nullopt;
  std::unordered_map<std::string_view, int> by_name;
  for (int j = 0; j < source.joint_count(); ++j) by_name.emplace(source.names[at(j)], j);
  SameSkeleton same;
  for (int k = 0; k < target.joint_count(); ++k) {
    const auto found = by_name.find(target.names[at(k)]);
    if (found == by_name.end()) return std::nullopt;
    const int parent = target.parents[at(k)];
    const int source_parent = source.parents[at(found->second)];
    const int expected = parent < 0 ? -1 : same.source_joint[at(parent)];
    if (source_parent != expected) return std::nullopt;
    same.source_joint.push_back(found->second);
  }
  return with_same_bones(source, target, std::move(same));
}

std::optional<SameSkeleton> same_body(const Skeleton& source, const RoleMap& source_roles,
                                      const Skeleton& target, const RoleMap& target_roles) {
  if (!source_roles.humanoid || !target_roles.humanoid || source.parents != target.parents) {
    return std::nullopt;
  }
  SameSkeleton same;
  for (int j = 0; j < source.joint_count(); ++j) {
    const Role role = source_roles.roles[at(j)];
    const int other = target_roles.joint(role);
    if (!is_role_of_many(role) && other >= 0 && other != j) return std::nullopt;
    const double turned = j == 0 ? 0
                                 : angle_between(source.reference_local(j).orientation,
                                                 target.reference_local(j).orientation);
    if (turned > kAxesTolerance) return std::nullopt;
    same.source_joint.push_back(j);
  }
  return with_same_bones(source, target, std::move(same));
}

std::optional<SameSkeleton> same_person(const Skeleton& source, const RoleMap& source_roles,
                                        const Skeleton& target, const RoleMap& target_roles) {
  if (!source_roles.humanoid || !target_roles.humanoid) return std::nullopt;
  if (!source_roles.given.empty() || !target_roles.given.empty()) return std::nullopt;
  const int hips = target_roles.joint(Role::hips);
  const bool alike = source.names == target.names && source.parents == target.parents;
  SameSkeleton same;
  for (int k = 0; k < target.joint_count(); ++k) {
    const Role role = target_roles.roles[at(k)];
    int& from = same.source_joint.emplace_back(source.find(target.names[at(k)]));
    const int parent = target.parents[at(k)];
    const int expected = parent < 0 ? -1 : same.source_joint[at(parent)];
    const bool below = from >= 0 && expected >= 0 && source.parents[at(from)] == expected;
    const bool above = from >= 0 && carries(target, k, hips) &&
                       carries(source, from, source_roles.joint(Role::hips));
    if (!below && !above) from = -1;
    const bool is_of_body = role != Role::none && role != Role::root && !is_role_of_many(role);
    if (is_of_body && (from < 0 || (!alike && source_roles.roles[at(from)] != role))) {
      return std::nullopt;
    }
  }
  const std::vector<SharedBone> bones = shared_bones(source, target, same);
  return with_bones_of_person(bones, target_roles, std::move(same));
}

}  // namespace krok::retarget
