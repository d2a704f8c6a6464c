#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/faded_goal_internal.h"
#include "math/quaternion.h"

namespace krok::ik {

namespace {

// The direction from the eye turned part of the way from where the joint looks now.
void fade_look(Goal& goal, double strength, const Transform& joint) {
  const Vec3 eye = joint * goal.point;
  const Vec3 facing = joint.orientation * goal.axis;
  const Vec3 line = goal.target - eye;
  const Quat turn = slerp(Quat::Identity(), shortest_arc(facing, line), strength);
  goal.target = eye + line.norm() * (turn * facing);
}

// The bend turned part of the way about the line through the limb's ends.
void fade_pole(Goal& goal, double strength, const Skeleton& skeleton,
               const std::vector<Transform>& pose) {
  const int upper = goal.upper >= 0 ? goal.upper : skeleton.parents[at(goal.joint)];
  int lower = goal.lower;
  for (int j = goal.joint + 1; lower < 0 && j < skeleton.joint_count(); ++j) {
    if (skeleton.parents[at(j)] == goal.joint) lower = j;
  }
  if (upper < 0 || lower < 0) return;
  const Vec3 origin = pose[at(upper)].position;
  const Vec3 line = pose[at(lower)].position - origin;
  if (!(line.norm() > 1e-9)) return;
  const Vec3 along = line.normalized();
  const auto across = [&](const Vec3& v) { return Vec3(v - along * along.dot(v)); };
  const Vec3 now = across(pose[at(goal.joint)].position - origin);
  const Vec3 then = across(goal.target - origin);
  if (!(now.norm() > 1e-9) || !(then.norm() > 1e-9)) return;
  const double angle = std::atan2(along.dot(now.cross(then)), now.dot(then));
  const Quat back(Eigen::AngleAxisd(-(1 - strength) * angle, along));
  goal.target = origin + along * along.dot(goal.target - origin) + back * then;
}

}  // namespace

void fade_goal(Goal& goal, double strength, const Skeleton& skeleton,
               const std::vector<Transform>& pose) {
  if (goal.kind == Goal::Kind::balance) {
    // A support so large that it holds the centre wherever it is shrinks to its size.
    Vec2 middle = Vec2::Zero();
    for (const Vec2& corner : goal.support) {
      middle += corner / static_cast<double>(goal.support.size());
    }
    for (Vec2& corner : goal.support) {
      corner = middle + (corner - middle) / std::max(strength, 1e-3);
    }
    return;
  }
  const Transform& joint = pose[at(goal.joint)];
  switch (goal.kind) {
    case Goal::Kind::look_at:
      fade_look(goal, strength, joint);
      break;
    case Goal::Kind::pole:
      fade_pole(goal, strength, skeleton, pose);
      break;
    default: {
      const Vec3 now = joint * goal.point;
      goal.target = now + strength * (goal.target - now);
      goal.orientation = slerp(joint.orientation, goal.orientation, strength);
      break;
    }
  }
}

}  // namespace krok::ik
