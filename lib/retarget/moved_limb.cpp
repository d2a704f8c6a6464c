#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "retarget/actor_view_internal.h"
#include "retarget/moved_limb.h"

namespace krok::retarget {

namespace {

// A correction of a limb's end without what comes of rounding, which would move a straight limb's
// middle by its square root: none below a ten-thousandth of the limb, or a few steps of a float at
// `place`; all of it from ten times that.
Vec3 beyond_rounding(const Vec3& correction, double length, const Vec3& place) {
  const double least =
      std::max(1e-4 * length, 8 * std::numeric_limits<float>::epsilon() * place.norm());
  return smooth_step(least, 10 * least, correction.norm()) * correction;
}

}  // namespace

std::vector<int> joints_below(const Skeleton& skeleton, int root) {
  std::vector<int> joints = {root};
  std::vector<char> inside(skeleton.names.size(), 0);
  inside[at(root)] = 1;
  for (int j = root + 1; j < skeleton.joint_count(); ++j) {
    if (inside[at(skeleton.parents[at(j)])] == 0) continue;
    inside[at(j)] = 1;
    joints.push_back(j);
  }
  return joints;
}

MovedLimb::MovedLimb(const Actor& actor, int upper, int lower, int end, const Vec3& hinge,
                     int carrier)
    : upper_(upper), lower_(lower), end_(end), carrier_(carrier) {
  const Vec3 bone = actor.pose[at(lower)].position - actor.pose[at(upper)].position;
  const Vec3 square = hinge - bone * (hinge.dot(bone) / std::max(bone.squaredNorm(), 1e-12));
  hinge_ = actor.pose[at(carrier)].orientation.conjugate() * square.normalized();
  const std::vector<int> below_lower = joints_below(actor.skeleton, lower);
  const std::vector<int> below_end = joints_below(actor.skeleton, end);
  for (const int joint : joints_below(actor.skeleton, upper)) {
    Follows follows = Follows::upper;
    if (std::binary_search(below_lower.begin(), below_lower.end(), joint)) follows = Follows::lower;
    if (std::binary_search(below_end.begin(), below_end.end(), joint)) follows = Follows::end;
    links_.push_back({joint, actor.skeleton.parents[at(joint)], follows});
  }
}

double MovedLimb::length(std::span<const Transform> pose) const {
  return (pose[at(lower_)].position - pose[at(upper_)].position).norm() +
         (pose[at(end_)].position - pose[at(lower_)].position).norm();
}

MovedLimb::Outcome MovedLimb::move_end(const Vec3& wanted, std::span<const Transform> local,
                                       std::span<Transform> pose, double softness) const {
  const Vec3 root = pose[at(upper_)].position;
  const Vec3 middle = pose[at(lower_)].position;
  const Vec3 end = pose[at(end_)].position;
  const Vec3 upper_bone = middle - root;
  const double full = length(pose);
  Outcome outcome;
  const Vec3 correction = beyond_rounding(wanted, full, end);
  outcome.correction = correction.norm();
  if (outcome.correction == 0) return outcome;
  const Vec3 goal = end + correction;
  // What keeps a knee from snapping also bends a straight one: in proportion to small corrections,
  // so that a limb that needs none is continued by one that does.
  const double soft = std::min(1.0, outcome.correction / (0.01 * full));

  // The direction of the middle joint: its present one if bent, from its hinge if straight.
  const Vec3 line = (end - root).stableNormalized();
  const Vec3 axis = pose[at(carrier_)].orientation * hinge_;
  const Vec3 by_hinge = line.cross(axis).stableNormalized();
  const Vec3 bent = upper_bone - line * line.dot(upper_bone);
  // The direction of a knee within 25 degrees of straight is unreliable.
  const double straight = 1 - smooth_step(0.05 * full, 0.11 * full, bent.norm());
  const Vec3 outward = bent + soft * (0.005 + 0.06 * straight) * full * by_hinge;
  // A limb that is folded until its end is at its root has no line: it bends about the axis.
  const double open = smooth_step(0.1 * full, 0.25 * full, (end - root).norm());
  const Vec3 square = upper_bone.cross(axis).cross(upper_bone).stableNormalized();
  const Vec3 hinge = open * outward.cross(line).stableNormalized() + (1 - open) * square;
  TwoBoneChain chain{root, middle, end, hinge};
  TwoBoneGoal to_reach;
  to_reach.target = goal;
  to_reach.pole = (goal - root).cross(chain.hinge);
  to_reach.softness = std::max(soft * 0.003 * full, softness);
  const TwoBoneSolution solution = solve_two_bone(chain, to_reach);
  outcome.miss = (solution.end - goal).norm();
  const auto bend = [](const Vec3& above, const Vec3& below) {
    return std::atan2(above.cross(below).norm(), above.dot(below));
  };
  outcome.bend =
      bend(solution.middle - root, solution.end - solution.middle) - bend(upper_bone, end - middle);
  turn(solution.root_rotation, solution.middle_rotation, local, pose);
  return outcome;
}

void MovedLimb::aim_middle(const Vec3& goal, std::span<const Transform> local,
                           std::span<Transform> pose) const {
  const Vec3& root = pose[at(upper_)].position;
  turn(shortest_arc(pose[at(lower_)].position - root, goal - root), Quat::Identity(), local, pose);
}

void MovedLimb::aim_end(const Vec3& point, const Vec3& goal, std::span<const Transform> local,
                        std::span<Transform> pose) const {
  const Vec3& middle = pose[at(lower_)].position;
  // The end keeps its orientation: what is between it and the point moves along with it.
  const Vec3 end = pose[at(end_)].position;
  turn(Quat::Identity(), shortest_arc(end - middle, goal - (point - end) - middle), local, pose);
}

void MovedLimb::turn(const Quat& upper, const Quat& lower, std::span<const Transform> local,
                     std::span<Transform> pose) const {
  for (const Link& link : links_) {
    Transform& transform = pose[at(link.joint)];
    if (link.follows == Follows::upper) {
      transform.orientation = (upper * transform.orientation).normalized();
    } else if (link.follows == Follows::lower) {
      transform.orientation = (lower * transform.orientation).normalized();
    }
    if (link.joint == upper_) continue;
    transform.position = pose[at(link.parent)] * local[at(link.joint)].position;
  }
}

}  // namespace krok::retarget
