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
constexpr double kAxesTolerance = 1e-4;    // radians

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

}  // namespace

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

}  // namespace krok::retarget
