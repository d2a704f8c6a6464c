#include "retarget/foot_bend.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "math/quaternion.h"
#include "retarget/actor_view_internal.h"
#include "retarget/joint_mapping.h"
#include "retarget/moved_limb.h"

namespace krok::retarget {

namespace {

// Radians up to which toes and foot bend freely, and at most: from one to the other less and less,
// so that what follows them begins without a jerk.
struct BendLimit {
  double free, most;

  double operator()(double angle) const {
    if (angle <= free) return std::max(angle, 0.0);
    return free + (most - free) * (1 - std::exp(-(angle - free) / (most - free)));
  }
};
constexpr BendLimit kToes = {50 * kRadiansPerDegree, 80 * kRadiansPerDegree};
constexpr BendLimit kFoot = {35 * kRadiansPerDegree, 60 * kRadiansPerDegree};

constexpr double kLong = 0.7;  // of the longest arm: what is bent up

// The angle by which an arm from a pivot has to be turned about `axis` for its end to be as high as
// `wanted`, or highest; 0 if it is not below that. Less, and none in the end, for one that sinks at
// first, as of a foot that lies on its instep.
double angle_to(double wanted, const Vec3& pivot, const Vec3& arm, const Vec3& axis) {
  // The height is middle + a cos + b sin.
  const double along = axis.y() * axis.dot(arm), middle = pivot.y() + along;
  const double a = arm.y() - along, b = axis.cross(arm).y();
  if (middle + a >= wanted) return 0;
  double highest = std::atan2(b, a);
  if (highest < 0) highest += 2 * kPi;
  const double from_highest =
      std::acos(std::clamp((wanted - middle) / std::max(std::hypot(a, b), 1e-12), -1.0, 1.0));
  const double angle = highest - from_highest;
  return (1 - smooth_step(0.8 * kPi, 0.95 * kPi, angle)) * angle;
}

}  // namespace

BendAngles bend_angles(double needed, double free) {
  const double toes = kToes(needed);
  return {toes, free * kFoot(needed - toes)};
}

double lowest_over(double floor, std::span<const FootPoint> points,
                   std::span<const Transform> pose) {
  double lowest = std::numeric_limits<double>::max();
  for (const FootPoint& point : points) lowest = std::min(lowest, point.over(floor, pose));
  return lowest;
}

FootBend::FootBend(const Actor& actor, Role foot, std::span<const FootPoint> points)
    : foot_(actor.roles.joint(foot)), below_foot_(joints_below(actor.skeleton, foot_)) {
  const std::vector<int> toes = first_toes(actor.skeleton, actor.roles, foot);
  if (toes.empty()) return;
  const Transform& ankle = actor.pose[at(foot_)];
  const Vec3 ahead = actor.pose[at(toes[toes.size() / 2])].position - ankle.position;
  right_ = ankle.orientation.conjugate() * ahead.cross(kUp).stableNormalized();
  for (const int joint : toes) {
    Toe& toe = toes_.emplace_back();
    toe.joint = joint;
    toe.below = joints_below(actor.skeleton, joint);
    std::ranges::copy_if(points, std::back_inserter(toe.points), [&](const FootPoint& point) {
      return std::ranges::binary_search(toe.below, point.point.joint) &&
             (point.point.joint != joint || !point.point.offset.isZero(0));
    });
    // What is near the joint would have to be bent far to rise.
    const auto arm = [&](const FootPoint& point) {
      return flat(ahead).dot(point.point.in(actor.pose) - actor.pose[at(joint)].position);
    };
    double longest = 0;
    for (const FootPoint& point : toe.points) longest = std::max(longest, arm(point));
    std::erase_if(toe.points, [&](const FootPoint& point) { return arm(point) < kLong * longest; });
  }
}

double FootBend::needed(double lowest, std::span<const Transform> pose) const {
  double needed = 0;
  if (toes_.empty()) return needed;
  const Vec3 axis = pose[at(foot_)].orientation * right_;
  for (const Toe& toe : toes_) {
    const Vec3& pivot = pose[at(toe.joint)].position;
    for (const FootPoint& point : toe.points) {
      const Vec3 arm = point.point.in(pose)-pivot;
      needed = std::max(needed, angle_to(lowest + point.height, pivot, arm, axis));
    }
  }
  return needed;
}

void FootBend::bend(double toes, double foot, std::span<Transform> pose) const {
  if (toes == 0 && foot == 0) return;
  const Quat of_toes = from_rotation_vector(toes * (pose[at(foot_)].orientation * right_));
  for (const Toe& toe : toes_) turn(of_toes, toe.below, pose);
  turn(turn_of_foot(foot, pose), below_foot_, pose);
}

// The axis is the same before and after.
Quat FootBend::turn_of_foot(double foot, std::span<const Transform> pose) const {
  return from_rotation_vector(foot * (pose[at(foot_)].orientation * right_));
}

void FootBend::turn(const Quat& by, const std::vector<int>& joints, std::span<Transform> pose) {
  const Vec3 pivot = pose[at(joints.front())].position;
  for (const int joint : joints) {
    Transform& moved = pose[at(joint)];
    moved.position = pivot + by * Vec3(moved.position - pivot);
    moved.orientation = (by * moved.orientation).normalized();
  }
}

}  // namespace krok::retarget
