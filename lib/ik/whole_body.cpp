#include "ik/whole_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/index.h"
#include "motion/hips_root.h"

namespace krok::ik {

namespace {

double size_of(const Skeleton& skeleton) {
  Eigen::AlignedBox3d box;
  for (const Transform& joint : skeleton.reference) box.extend(joint.position);
  return box.sizes().maxCoeff();
}

}  // namespace

std::vector<std::uint8_t> sought_by(std::span<const KeyedGoal> goals, const Skeleton& skeleton) {
  std::vector<std::uint8_t> sought(skeleton.names.size(), 0);
  for (const KeyedGoal& goal : goals) {
    if (goal.goal.kind == Goal::Kind::balance) continue;
    const std::vector<std::uint8_t> below = subtree(skeleton, goal.goal.joint);
    for (std::size_t j = 0; j < sought.size(); ++j) sought[j] |= below[j];
  }
  return sought;
}

std::vector<HeldFoot> legs_without_goals(const Clip& clip, const RoleMap& roles,
                                         std::span<const KeyedGoal> goals) {
  std::vector<HeldFoot> legs;
  for (const LegRoles& leg : kLegRoles) {
    HeldFoot held{roles.joint(leg.upper), roles.joint(leg.lower), roles.joint(leg.foot)};
    if (held.foot < 0 || held.upper < 0 || held.lower < 0) continue;
    const std::vector<std::uint8_t> within = subtree(clip.skeleton, held.upper);
    const bool sought = std::ranges::any_of(
        goals, [&](const KeyedGoal& goal) { return within[at(goal.goal.joint)] != 0; });
    if (sought) continue;
    Vec3 bend = Vec3::Zero();
    for (int f = 0; f < clip.frame_count(); ++f) {
      const auto places = clip.frame_positions(f);
      const Vec3f thigh = places[at(held.lower)] - places[at(held.upper)];
      const Vec3f shank = places[at(held.foot)] - places[at(held.lower)];
      const Quatf& frame = clip.frame_orientations(f)[at(held.upper)];
      bend += (frame.conjugate() * thigh.cross(shank)).cast<double>();
    }
    if (bend.norm() > 0) held.knee_axis = bend.normalized();
    legs.push_back(held);
  }
  return legs;
}

namespace {

// 1 for joints beside a goal's, such as the other fingers of a hand: they hang on its parent,
// hardly farther away than what the goal moves. Held, they would hold that joint, too. [joints]
std::vector<std::uint8_t> beside_goals(std::span<const KeyedGoal> goals, const Skeleton& skeleton) {
  constexpr double kBeside = 1.5;
  std::vector<std::uint8_t> beside(skeleton.names.size(), 0);
  for (const KeyedGoal& goal : goals) {
    const int parent =
        goal.goal.kind == Goal::Kind::balance ? -1 : skeleton.parents[at(goal.goal.joint)];
    if (parent <= 0) continue;
    const std::vector<std::uint8_t> moved = subtree(skeleton, goal.goal.joint);
    const std::vector<std::uint8_t> below = subtree(skeleton, parent);
    std::vector<double> way(below.size(), 0);  // metres along the bones from the parent
    double longest = 0;
    for (std::size_t j = at(parent) + 1; j < below.size(); ++j) {
      if (below[j] == 0) continue;
      way[j] = way[at(skeleton.parents[j])] +
               skeleton.reference_local(static_cast<int>(j)).position.norm();
      if (moved[j] != 0) longest = std::max(longest, way[j]);
    }
    for (std::size_t j = 0; j < below.size(); ++j) {
      beside[j] |= below[j] != 0 && way[j] <= kBeside * longest ? 1 : 0;
    }
  }
  return beside;
}

}  // namespace

std::vector<HeldFoot> ends_on_ground(const Clip& clip, std::span<const KeyedGoal> goals) {
  constexpr double kNear = 0.1;  // of the skeleton's size: ankles are ends, too
  const Skeleton& skeleton = clip.skeleton;
  const std::size_t joints = skeleton.names.size();
  const std::vector<std::uint8_t> sought = sought_by(goals, skeleton);
  const std::vector<std::uint8_t> beside = beside_goals(goals, skeleton);
  std::vector<std::uint8_t> is_end(joints, 1);
  std::vector<float> lowest(joints, std::numeric_limits<float>::max());
  for (std::size_t j = 0; j < joints; ++j) {
    if (skeleton.end_sites[j] != 0) is_end[j] = 0;
    if (skeleton.end_sites[j] == 0 && skeleton.parents[j] >= 0) is_end[at(skeleton.parents[j])] = 0;
    for (int f = 0; f < clip.frame_count(); ++f) {
      lowest[j] = std::min(lowest[j], clip.frame_positions(f)[j].y());
    }
  }
  const double ground = *std::ranges::min_element(lowest) + kNear * size_of(skeleton);
  std::vector<HeldFoot> ends;
  for (std::size_t j = 0; j < joints; ++j) {
    if (is_end[j] == 0 || sought[j] != 0 || beside[j] != 0 || lowest[j] > ground) continue;
    ends.push_back({-1, -1, static_cast<int>(j)});
  }
  return ends;
}

namespace {

// Ends that hang on the root by no limb, as controls of feet do, do not follow a root that moves:
// the joint below it that carries what goals are for, and none of them.
int joint_beside_ends(const Clip& clip, std::span<const KeyedGoal> goals) {
  constexpr double kLimb = 0.15;  // of the skeleton's size
  const Skeleton& skeleton = clip.skeleton;
  const auto ends = ends_on_ground(clip, goals);
  if (ends.empty() || goals.empty()) return 0;
  int beside = -1;
  for (int j = goals.front().goal.joint; j > 0; j = skeleton.parents[at(j)]) {
    const std::vector<std::uint8_t> within = subtree(skeleton, j);
    const auto carried = [&](const auto& end) { return within[at(end.foot)] != 0; };
    const auto sought = [&](const auto& goal) { return within[at(goal.goal.joint)] != 0; };
    if (std::ranges::any_of(ends, carried)) break;
    if (std::ranges::all_of(goals, sought)) beside = j;
  }
  if (beside < 0) return 0;
  const std::vector<std::uint8_t> common = subtree(skeleton, skeleton.parents[at(beside)]);
  for (const HeldFoot& end : ends) {
    double limb = 0;
    for (int j = end.foot;
         j > 0 && skeleton.parents[at(j)] != skeleton.parents[at(beside)] && common[at(j)] != 0;
         j = skeleton.parents[at(j)]) {
      limb += skeleton.reference_local(j).position.norm();
    }
    if (limb < kLimb * size_of(skeleton)) return beside;
  }
  return 0;
}

}  // namespace

int moving_joint(const Clip& clip, const RoleMap& roles, std::span<const KeyedGoal> goals) {
  constexpr double kNear = 0.1;  // of a thigh's length
  const auto& parents = clip.skeleton.parents;
  std::vector<int> carried;
  for (const LegRoles& leg : kLegRoles) carried.push_back(roles.joint(leg.upper));
  if (std::ranges::count(carried, -1) > 0) return joint_beside_ends(clip, goals);
  const std::vector<int> trunk = roles.joints(Role::spine);
  carried.insert(carried.end(), trunk.begin(), trunk.end());
  int pelvis = std::max(roles.joint(Role::hips), 0);
  const auto carries_all = [&](int joint) {
    const std::vector<std::uint8_t> within = subtree(clip.skeleton, joint);
    return std::ranges::all_of(carried, [&](int j) { return within[at(j)] != 0; });
  };
  while (pelvis > 0 && !carries_all(pelvis)) pelvis = parents[at(pelvis)];
  // The mean distance of a joint from another, metres.
  const auto distance = [&](int one, int other) {
    double sum = 0;
    for (int f = 0; f < clip.frame_count(); ++f) {
      const auto places = clip.frame_positions(f);
      sum += (places[at(one)] - places[at(other)]).norm();
    }
    return sum / std::max(1, clip.frame_count());
  };
  const double near =
      kNear * distance(roles.joint(kLegRoles[0].upper), roles.joint(kLegRoles[0].lower));
  int moving = pelvis;
  while (moving > 0 && distance(parents[at(moving)], pelvis) <= near) moving = parents[at(moving)];
  return moving;
}

}  // namespace krok::ik
