#include "ik/keyed_goal_internal.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/sample.h"

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

double cross_of(const Vec2& o, const Vec2& a, const Vec2& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
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
    default:
      goal.orientation = slerp(joint.orientation, goal.orientation, strength);
      break;
  }
}

Status check_goal(const KeyedGoal& goal, const Skeleton& skeleton) {
  const auto wrong = [&](const char* what) {
    return Error("ik-goal", fmt::format("goal '{}' {}", goal.name, what));
  };
  // A goal that fades reads the pose before the solver checks the goal.
  const auto lacks = [](const Skeleton& of, int joint) {
    return joint < 0 || joint >= of.joint_count();
  };
  const Goal::Kind kind = goal.goal.kind;
  if (kind != Goal::Kind::balance && lacks(skeleton, goal.goal.joint)) {
    return wrong("is for a joint that does not exist");
  }
  if (goal.goal.upper >= skeleton.joint_count() || goal.goal.lower >= skeleton.joint_count()) {
    return wrong("is a pole between joints that do not exist");
  }
  if (goal.relative_to >= 0 &&
      lacks(goal.motion != nullptr ? goal.motion->skeleton : skeleton, goal.relative_to)) {
    return wrong("is relative to a joint that does not exist");
  }
  for (const int joint : goal.support_joints) {
    if (lacks(skeleton, joint)) return wrong("is supported by a joint that does not exist");
  }
  if (goal.keys.empty() && goal.goal.kind != Goal::Kind::balance) return wrong("has no keys");
  for (std::size_t i = 0; i < goal.keys.size(); ++i) {
    const GoalKey& key = goal.keys[i];
    if (!std::isfinite(key.time) || (i > 0 && !(key.time > goal.keys[i - 1].time))) {
      return wrong("has keys whose times do not increase");
    }
    if (!key.target.allFinite() || !(std::abs(key.orientation.norm() - 1) < 1e-6)) {
      return wrong("has a key whose values are not finite");
    }
  }
  if (!(goal.fade_in >= 0) || !(goal.fade_out >= 0)) return wrong("has a negative fade");
  return {};
}

Goal placed(const KeyedGoal& keyed, double time, const Transform& frame,
            std::span<const Transform> pose) {
  Goal goal = keyed.goal;
  const GoalKey key = key_at(keyed, time);
  goal.target = frame * key.target;
  goal.orientation = (frame.orientation * key.orientation).normalized();
  if (!keyed.support_joints.empty()) {
    std::vector<Vec2> points;
    for (const int joint : keyed.support_joints) {
      const Vec3& place = pose[at(joint)].position;
      points.emplace_back(place.x(), place.z());
    }
    goal.support = outline(std::move(points));
  }
  return goal;
}

std::vector<Vec2> outline(std::vector<Vec2> points) {
  const auto before = [](const Vec2& a, const Vec2& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2> hull;
  const auto add = [&](const Vec2& point, std::size_t keep) {
    while (hull.size() > keep && cross_of(hull[hull.size() - 2], hull.back(), point) <= 0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const Vec2& point : points) add(point, 1);
  const std::size_t lower = hull.size();
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.pop_back();
  return hull;
}

FullStrength full_strength(const KeyedGoal& goal, double duration, double rate) {
  double from = goal.from.value_or(goal.keys.empty() ? 0 : goal.keys.front().time);
  double to =
      std::max(from, goal.to.value_or(goal.keys.empty() ? duration : goal.keys.back().time));
  const bool between_frames = std::ceil(from * rate) / rate > to;
  if (between_frames && from <= duration) {
    from = to = std::min(std::round(std::midpoint(from, to) * rate) / rate, duration);
  }
  return {from, to};
}

double strength_at(const KeyedGoal& goal, double time, double duration, double rate) {
  // Some easings overshoot.
  const auto eased = [&](double u) { return std::clamp(goal.fade.at(u), 0.0, 1.0); };
  const FullStrength full = full_strength(goal, duration, rate);
  if (time < full.from) {
    return goal.fade_in > 0 ? eased((time - full.from + goal.fade_in) / goal.fade_in) : 0;
  }
  if (time > full.to) {
    return goal.fade_out > 0 ? eased((full.to + goal.fade_out - time) / goal.fade_out) : 0;
  }
  return 1;
}

GoalKey key_at(const KeyedGoal& goal, double time) {
  if (goal.keys.empty()) return {};
  const auto after = std::upper_bound(goal.keys.begin(), goal.keys.end(), time,
                                      [](double t, const GoalKey& key) { return t < key.time; });
  if (after == goal.keys.begin()) return goal.keys.front();
  const GoalKey& one = *(after - 1);
  if (after == goal.keys.end()) return one;
  const double u = one.easing.at((time - one.time) / (after->time - one.time));
  GoalKey key = one;
  key.time = time;
  key.target = one.target + u * (after->target - one.target);
  key.orientation = slerp(one.orientation, after->orientation, u);
  return key;
}

Goal goal_in_frame(const KeyedGoal& goal, const Clip& clip, int frame) {
  const double time = frame / clip.rate;
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(frame, pose);
  Transform anchor;
  if (goal.motion != nullptr && goal.relative_to >= 0) {
    std::vector<Transform> other(goal.motion->skeleton.names.size()), scratch(3 * other.size());
    sample(*goal.motion, time, other, scratch);
    anchor = other[at(goal.relative_to)];
  } else if (goal.relative_to >= 0) {
    anchor = pose[at(goal.relative_to)];
  }
  return placed(goal, time, anchor, pose);
}

}  // namespace krok::ik
