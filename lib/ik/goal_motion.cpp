#include "ik/goal_motion.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "core/parallel.h"
#include "ik/goal.h"
#include "math/quaternion.h"
#include "motion/sample.h"
#include "scene/skeleton.h"

namespace krok::ik {

namespace {

// Moves a goal's target towards what the pose does without it: strength 0 asks for the pose as it
// is, 1 for the goal.
void fade_goal(Goal& goal, double strength, const Skeleton& skeleton,
               const std::vector<Transform>& joint_to_world);

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

// Frames that one thread solves in a row.
constexpr std::size_t kGrain = 32;
// A motion that is beyond its limits by so much, radians, is blended by a goal's strength alone.
constexpr double kWhollyBlended = 0.1;

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

// The goal at a time, with its keys in `frame`, on the support joints of a pose.
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

double cross_of(const Vec2& o, const Vec2& a, const Vec2& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

}  // namespace

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

double strength_at(const KeyedGoal& goal, double time, double duration) {
  // Some easings overshoot.
  const auto eased = [&](double u) { return std::clamp(goal.fade.at(u), 0.0, 1.0); };
  const double from = goal.from.value_or(goal.keys.empty() ? 0 : goal.keys.front().time);
  const double to =
      std::max(from, goal.to.value_or(goal.keys.empty() ? duration : goal.keys.back().time));
  if (time < from) {
    return goal.fade_in > 0 ? eased((time - from + goal.fade_in) / goal.fade_in) : 0;
  }
  if (time > to) {
    return goal.fade_out > 0 ? eased((to + goal.fade_out - time) / goal.fade_out) : 0;
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

namespace {

// Solves one frame after the other; one for each thread.
class FrameSolver {
 public:
  FrameSolver(const Clip& clip, std::span<const KeyedGoal> goals, Solver solver)
      : clip_(clip), goals_(goals), solver_(std::move(solver)) {
    const std::size_t joints = clip.skeleton.names.size();
    given_.resize(joints);
    solved_.resize(joints);
    for (const KeyedGoal& goal : goals) {
      if (goal.motion) {
        other_.resize(std::max(other_.size(), goal.motion->skeleton.names.size()));
      }
    }
    scratch_.resize(3 * other_.size());
  }

  Status solve(int frame, std::span<GoalFrame> report, Clip& result, double& excess);

 private:
  Transform anchor(const KeyedGoal& goal, double time);
  void list_goals(double time);
  bool blend_in(double strength);
  double excess_of_chains() const;

  const Clip& clip_;
  std::span<const KeyedGoal> goals_;
  Solver solver_;
  std::vector<Transform> given_, solved_, other_, scratch_, local_, before_solving_;
  std::vector<Goal> active_;
  std::vector<double> strengths_;
};

// As the motion is given.
Transform FrameSolver::anchor(const KeyedGoal& goal, double time) {
  if (goal.relative_to < 0) return {};
  if (!goal.motion) return given_[at(goal.relative_to)];
  const std::size_t joints = goal.motion->skeleton.names.size();
  sample(*goal.motion, time, std::span(other_).first(joints), scratch_);
  return other_[at(goal.relative_to)];
}

void FrameSolver::list_goals(double time) {
  active_.clear();
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    if (!(strengths_[g] > 0)) continue;
    const KeyedGoal& keyed = goals_[g];
    const Transform frame = anchor(keyed, time);
    Goal goal = placed(keyed, time, frame, given_);
    if (strengths_[g] < 1) fade_goal(goal, strengths_[g], clip_.skeleton, given_);
    if (keyed.relative_to >= 0 && keyed.motion == nullptr) {
      // The solution moves its frame.
      goal.anchor = keyed.relative_to;
      goal.target = frame.inverse() * goal.target;
      goal.orientation = (frame.orientation.conjugate() * goal.orientation).normalized();
    }
    active_.push_back(std::move(goal));
  }
}

// Where the motion itself is beyond limits of a chain, the solution is another pose than the
// motion's even as a goal only begins to count. The turns are then blended by the goal's strength;
// the less the motion is beyond its limits, the less is blended, so that nothing jumps.
bool FrameSolver::blend_in(double strength) {
  const Limits& limits = solver_.limits();
  if (limits.empty() || strength >= 1) return false;
  const auto& parents = clip_.skeleton.parents;
  local_.resize(given_.size());
  before_solving_.resize(given_.size());
  world_to_local(parents, solved_, local_);
  world_to_local(parents, given_, before_solving_);
  double beyond = 0;
  for (std::size_t j = 0; j < local_.size(); ++j) {
    if (angle_between(local_[j].orientation, before_solving_[j].orientation) < 1e-9) continue;
    beyond = std::max(beyond, excess(limits[j], before_solving_[j].orientation));
  }
  if (!(beyond > 1e-9)) return false;
  const double part = 1 + (strength - 1) * std::min(1.0, beyond / kWhollyBlended);
  for (std::size_t j = 0; j < local_.size(); ++j) {
    local_[j].orientation =
        slerp(before_solving_[j].orientation, local_[j].orientation, part).normalized();
    local_[j].position += (1 - part) * (before_solving_[j].position - local_[j].position);
  }
  local_to_world(parents, local_, solved_);
  return true;
}

double FrameSolver::excess_of_chains() const {
  const Limits& limits = solver_.limits();
  double largest = 0;
  for (std::size_t j = 1; j < limits.size(); ++j) {
    const Transform& parent = solved_[at(clip_.skeleton.parents[j])];
    const Transform& parent_before = given_[at(clip_.skeleton.parents[j])];
    const Quat local = parent.orientation.conjugate() * solved_[j].orientation;
    const Quat before = parent_before.orientation.conjugate() * given_[j].orientation;
    if (angle_between(local, before) < 1e-9) continue;
    largest = std::max(largest, excess(limits[j], local));
  }
  return largest;
}

Status FrameSolver::solve(int frame, std::span<GoalFrame> report, Clip& result, double& excess) {
  const double time = frame / clip_.rate;
  strengths_.clear();
  double strength = 0;
  for (const KeyedGoal& goal : goals_) {
    strengths_.push_back(strength_at(goal, time, clip_.duration()));
    strength = std::max(strength, strengths_.back());
  }
  if (!(strength > 0)) return {};
  clip_.get_pose(frame, given_);
  list_goals(time);
  solved_ = given_;
  const auto solution = solver_.solve(active_, solved_);
  if (!solution) return solution.error();
  const Outcome* const outcome = *solution;
  if (strength >= 1) excess = std::max(excess, excess_of_chains());
  std::vector<Residual> missed = outcome->goals;
  if (blend_in(strength)) {
    const auto& parents = clip_.skeleton.parents;
    const auto blended = residuals(active_, parents, solved_, solver_.options());
    for (std::size_t i = 0; i < missed.size(); ++i) {
      const int held_by = missed[i].held_by;
      missed[i] = blended[i];
      if (!missed[i].reached) missed[i].held_by = held_by;
    }
  }
  result.set_pose(frame, solved_);
  std::size_t next = 0;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    report[g] = {frame, strengths_[g], {}};
    if (strengths_[g] > 0) report[g].residual = missed[next++];
  }
  return {};
}

}  // namespace

Result<GoalMotion> apply_goals(const Clip& clip, std::span<const KeyedGoal> goals,
                               const Limits& limits, const GoalMotionOptions& options) {
  for (const KeyedGoal& goal : goals) {
    if (Status status = check_goal(goal, clip.skeleton); !status) return status.error();
  }
  // Says now what is wrong with limits and options.
  if (auto solver = Solver::create(clip.skeleton.parents, limits, options.solver); !solver) {
    return solver.error();
  }
  GoalMotion result;
  result.clip = clip;
  const std::size_t frames = at(clip.frame_count());
  std::vector<GoalFrame> report(frames * goals.size());
  const std::size_t ranges = (frames + kGrain - 1) / kGrain;
  std::vector<Status> failed(ranges);
  std::vector<double> excesses(ranges, 0.0);
  parallel_for(frames, kGrain, options.jobs, [&](std::size_t begin, std::size_t end) {
    FrameSolver solver(clip, goals, *Solver::create(clip.skeleton.parents, limits, options.solver));
    for (std::size_t f = begin; f < end && failed[begin / kGrain].ok(); ++f) {
      failed[begin / kGrain] = solver.solve(
          static_cast<int>(f), std::span(report).subspan(f * goals.size(), goals.size()),
          result.clip, excesses[begin / kGrain]);
    }
  });
  for (const Status& status : failed) {
    if (!status) {
      Status copy = status;
      return copy.error();
    }
  }
  for (const double excess : excesses) {
    result.largest_excess = std::max(result.largest_excess, excess);
  }
  result.goals.resize(goals.size());
  for (std::size_t f = 0; f < frames; ++f) {
    bool changed = false;
    for (std::size_t g = 0; g < goals.size(); ++g) {
      const GoalFrame& one = report[f * goals.size() + g];
      if (!(one.strength > 0)) continue;
      changed = true;
      result.goals[g].push_back(one);
    }
    result.changed_frames += changed ? 1 : 0;
  }
  return result;
}

}  // namespace krok::ik
