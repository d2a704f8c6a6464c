#include "ik/goal_motion.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/index.h"
#include "core/parallel.h"
#include "ik/goal.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "motion/sample.h"
#include "scene/frame_blocks.h"
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
    default:
      goal.orientation = slerp(joint.orientation, goal.orientation, strength);
      break;
  }
}

// The axis about which a knee bends to a distance: the captured one, which gives way to the usual
// one as flexion is added to a leg that is nearly straight, or bent backwards.
Vec3 knee_axis(const TwoBoneChain& chain, const Vec3& target, const Vec3& usual_axis) {
  constexpr double kStraight = 0.1, kBent = 0.7;  // radians
  const Vec3 thigh = chain.middle - chain.root, shank = chain.end - chain.middle;
  const Vec3 line = (chain.end - chain.root).stableNormalized();
  const Vec3 usual = (usual_axis - line * line.dot(usual_axis)).stableNormalized();
  const Vec3 hinge = thigh.cross(shank);
  if (hinge.norm() < 1e-5 * thigh.norm() * shank.norm()) return usual;
  const double angle = std::atan2(line.dot(usual.cross(hinge)), usual.dot(hinge));
  const auto bend_at = [&](const Vec3& end) {
    return two_bone_bend(thigh.norm(), shank.norm(), (end - chain.root).norm());
  };
  const double bend = bend_at(chain.end), added = std::max(0.0, bend_at(target) - bend);
  const double u = std::min(1.0, added / std::max(bend, kStraight));
  double part = u * u * (3 - 2 * u);
  if (std::abs(angle) < kPi / 2) part *= std::max(0.0, 1 - bend / kBent);
  return from_rotation_vector((1 - part) * angle * line) * usual;
}

constexpr double kForgets = 0.25;  // seconds, of the frame before
constexpr int kFirstSolves = 20;   // each as many steps as Options::iterations at most
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

// Of the frame before, for each goal: what it turned in the joints' frames, all of them together,
// or, as it fades, what it alone turns at full strength.
struct TurnsBefore {
  std::vector<std::vector<Vec3>> turns;  // [goals][joints]
  std::vector<double> strengths;         // [goals]
};

// Solves one frame after the other; one for each thread. `run` is of a take that lasts `duration`
// seconds; its frames are numbered as in the take.
class FrameSolver {
 public:
  FrameSolver(const FrameRun& run, double duration, std::span<const KeyedGoal> goals,
              const GoalMotionOptions& options, Solver solver, TurnsBefore before)
      : clip_(run.clip),
        first_(run.first),
        duration_(duration),
        goals_(goals),
        options_(options),
        solver_(std::move(solver)),
        turns_(std::move(before.turns)),
        strengths_before_(std::move(before.strengths)) {
    const Clip& clip = run.clip;
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
  TurnsBefore before() && { return {std::move(turns_), std::move(strengths_before_)}; }

 private:
  Transform anchor(const KeyedGoal& goal, double time);
  Status list_goals(double time);
  bool fades_by_turns(std::size_t g) const;
  Status fade_by_turns(std::size_t g, bool first, Goal& goal);
  void turn_given(const std::vector<Vec3>& turns, double part);
  void list_turns(std::vector<Vec3>& turns);
  void mark_chains();
  void hold();
  void bend_legs();
  void turn_to(int joint, const Quat& orientation);
  void start_from_before();
  void start_limbs();
  void keep_upright();
  bool blend_in(double strength);
  double excess_of_chains() const;

  const Clip& clip_;
  int first_;  // number of its first frame
  double duration_;
  std::span<const KeyedGoal> goals_;
  const GoalMotionOptions& options_;
  Solver solver_;
  std::vector<Transform> given_, solved_, other_, scratch_, local_, before_solving_;
  std::vector<Goal> active_;
  std::vector<double> strengths_;
  std::vector<const HeldFoot*> held_;             // in this frame
  std::vector<std::uint8_t> in_chain_;            // [joints], of the frame's goals
  std::vector<std::vector<Vec3>> turns_;          // see TurnsBefore
  std::vector<double> strengths_before_, parts_;  // how much of the turns is in the start
  std::vector<Vec3> mean_;
};

// As the motion is given.
Transform FrameSolver::anchor(const KeyedGoal& goal, double time) {
  if (goal.relative_to < 0) return {};
  if (!goal.motion) return given_[at(goal.relative_to)];
  const std::size_t joints = goal.motion->skeleton.names.size();
  sample(*goal.motion, time, std::span(other_).first(joints), scratch_);
  return other_[at(goal.relative_to)];
}

Status FrameSolver::list_goals(double time) {
  active_.clear();
  turns_.resize(goals_.size());
  strengths_before_.resize(goals_.size(), 0.0);
  parts_.assign(goals_.size(), 0.0);
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    const double strength = strengths_[g], before = std::exchange(strengths_before_[g], strength);
    if (!(before > 0)) turns_[g].assign(given_.size(), Vec3::Zero());
    if (!(strength > 0)) continue;
    const KeyedGoal& keyed = goals_[g];
    const Transform frame = anchor(keyed, time);
    Goal goal = placed(keyed, time, frame, given_);
    if (strength < 1 && !fades_by_turns(g)) fade_goal(goal, strength, clip_.skeleton, given_);
    if (keyed.relative_to >= 0 && keyed.motion == nullptr) {
      // The solution moves its frame.
      goal.anchor = keyed.relative_to;
      goal.target = frame.inverse() * goal.target;
      goal.orientation = (frame.orientation.conjugate() * goal.orientation).normalized();
    }
    parts_[g] = std::exp(-1 / (kForgets * clip_.rate));
    if (fades_by_turns(g)) {
      if (Status status = fade_by_turns(g, !(before > 0), goal); !status) return status;
    } else if (strength < before) {
      parts_[g] *= strength / before;
    }
    active_.push_back(std::move(goal));
  }
  return {};
}

bool FrameSolver::fades_by_turns(std::size_t g) const {
  const Goal::Kind kind = goals_[g].goal.kind;
  return strengths_[g] < 1 && (kind == Goal::Kind::position || kind == Goal::Kind::pose);
}

// The target where the joint is once the turns that the goal alone brings about are made in part.
// On the straight way between both places a limb would pass its full length, where its middle turns
// by any angle in no time, or come near the joint that it hangs on.
Status FrameSolver::fade_by_turns(std::size_t g, bool first, Goal& goal) {
  std::vector<Vec3>& turns = turns_[g];
  turn_given(turns, parts_[g]);
  const int moving = solver_.options().moving_joint;
  // In its parent's frame.
  const auto place = [&] {
    const int parent = clip_.skeleton.parents[at(moving)];
    const Vec3& position = solved_[at(moving)].position;
    return parent < 0 ? position : Vec3(solved_[at(parent)].inverse() * position);
  };
  const bool shifts = solver_.options().root_moves;
  Vec3 shift = shifts ? place() : Vec3(Vec3::Zero());
  // With the feet that it may not take along.
  std::vector<Goal> others = std::exchange(active_, {goal});
  mark_chains();
  hold();
  // A motion may begin as a goal already fades in: far from the solution.
  for (int solves = first ? kFirstSolves : 1; solves > 0; --solves) {
    if (auto alone = solver_.solve(active_, solved_); !alone) return alone.error();
  }
  bend_legs();
  active_ = std::move(others);
  if (shifts) shift = strengths_[g] * (place() - shift);
  list_turns(turns);
  parts_[g] = strengths_[g];
  turn_given(turns, parts_[g]);
  if (shifts) {
    local_[at(moving)].position += shift;
    local_to_world(clip_.skeleton.parents, local_, solved_);
  }
  const Transform frame = goal.anchor >= 0 ? solved_[at(goal.anchor)] : Transform();
  const Transform& joint = solved_[at(goal.joint)];
  goal.target = frame.inverse() * (joint * goal.point);
  goal.orientation = (frame.orientation.conjugate() * joint.orientation).normalized();
  return {};
}

void FrameSolver::mark_chains() {
  const auto& parents = clip_.skeleton.parents;
  in_chain_.assign(parents.size(), 0);
  for (const Goal& goal : active_) {
    if (goal.kind == Goal::Kind::balance) in_chain_.assign(parents.size(), 1);
    if (goal.kind == Goal::Kind::balance) continue;
    int left = goal.depth > 0 ? goal.depth : static_cast<int>(parents.size());
    int joint = goal.joint;
    if (goal.kind == Goal::Kind::pole) joint = goal.lower >= 0 ? goal.lower : joint + 1;
    for (; joint >= 0 && left > 0; joint = parents[at(joint)], --left) in_chain_[at(joint)] = 1;
  }
}

// Adds goals for what others would take along.
void FrameSolver::hold() {
  const auto& parents = clip_.skeleton.parents;
  held_.clear();
  for (const HeldFoot& leg : options_.held) {
    const int joint = leg.foot;
    int carrier = joint;
    while (carrier >= 0 && in_chain_[at(carrier)] == 0) carrier = parents[at(carrier)];
    if (carrier < 0 && !solver_.options().root_moves) continue;
    Goal goal;
    goal.kind = Goal::Kind::pose;
    goal.joint = joint;
    goal.target = given_[at(joint)].position;
    goal.orientation = given_[at(joint)].orientation;
    goal.weight = kHeldWeight;
    active_.push_back(goal);
    held_.push_back(&leg);
  }
  mark_chains();
}

// Legs from where the hips are now to where the feet were. The solver only sees to it that they
// reach: it would as soon bend a knee backwards.
void FrameSolver::bend_legs() {
  const auto& parents = clip_.skeleton.parents;
  for (const HeldFoot* leg : held_) {
    if (leg->upper < 0) continue;
    const int above = parents[at(leg->upper)];
    const Transform moved =
        above < 0 ? Transform() : solved_[at(above)] * given_[at(above)].inverse();
    const auto carried = [&](int joint) { return moved * given_[at(joint)]; };
    const Transform upper = carried(leg->upper), lower = carried(leg->lower);
    TwoBoneChain chain{upper.position, lower.position, carried(leg->foot).position, Vec3::Zero()};
    TwoBoneGoal goal;
    goal.target = given_[at(leg->foot)].position;
    chain.hinge = knee_axis(chain, goal.target, upper.orientation * leg->knee_axis);
    const Vec3 line = chain.end - chain.root, wanted = goal.target - chain.root;
    goal.pole = wanted.cross(shortest_arc(line, wanted) * chain.hinge);
    const TwoBoneSolution solution = solve_two_bone(chain, goal);
    turn_to(leg->upper, solution.root_rotation * upper.orientation);
    turn_to(leg->lower, solution.middle_rotation * lower.orientation);
    turn_to(leg->foot, given_[at(leg->foot)].orientation);
  }
}

// Turns a joint to an orientation in the world, with all that hangs on it.
void FrameSolver::turn_to(int joint, const Quat& orientation) {
  const auto& parents = clip_.skeleton.parents;
  local_.resize(solved_.size());
  world_to_local(parents, solved_, local_);
  const int parent = parents[at(joint)];
  const Quat above = parent < 0 ? Quat::Identity() : solved_[at(parent)].orientation;
  local_[at(joint)].orientation = (above.conjugate() * orientation).normalized();
  local_to_world(parents, local_, solved_);
}

// The solution starts from the frame as it was, its joints turned by a part of these.
void FrameSolver::turn_given(const std::vector<Vec3>& turns, double part) {
  const auto& parents = clip_.skeleton.parents;
  solved_ = given_;
  local_.resize(given_.size());
  world_to_local(parents, given_, local_);
  for (std::size_t j = 0; j < local_.size(); ++j) {
    if (turns[j].isZero()) continue;
    local_[j].orientation = local_[j].orientation * from_rotation_vector(part * turns[j]);
  }
  local_to_world(parents, local_, solved_);
}

// What the solution turned.
void FrameSolver::list_turns(std::vector<Vec3>& turns) {
  const auto& parents = clip_.skeleton.parents;
  local_.resize(given_.size());
  before_solving_.resize(given_.size());
  world_to_local(parents, solved_, local_);
  world_to_local(parents, given_, before_solving_);
  turns.resize(given_.size());
  for (std::size_t j = 0; j < local_.size(); ++j) {
    turns[j] = rotation_vector(before_solving_[j].orientation.conjugate() * local_[j].orientation);
  }
}

// The frame as it was, plus most of what goals changed in the frame before; of a joint that several
// turned the mean.
void FrameSolver::start_from_before() {
  mean_.assign(given_.size(), Vec3::Zero());
  for (std::size_t j = 0; j < mean_.size(); ++j) {
    double weights = 0;
    for (std::size_t g = 0; g < goals_.size() && in_chain_[j] != 0; ++g) {
      if (!(strengths_[g] > 0) || turns_[g][j].isZero()) continue;
      weights += strengths_[g];
      mean_[j] += strengths_[g] * parts_[g] * turns_[g][j];
    }
    if (weights > 0) mean_[j] /= weights;
  }
  turn_given(mean_, 1);
  if (solver_.options().method == Method::two_bone) start_limbs();
}

// In closed form a limb's own bend shows its plane, which a straight limb does not have, and its
// end keeps where it faces.
void FrameSolver::start_limbs() {
  const auto& parents = clip_.skeleton.parents;
  for (const Goal& goal : active_) {
    const int middle = goal.kind == Goal::Kind::balance ? -1 : parents[at(goal.joint)];
    if (middle < 0 || parents[at(middle)] < 0) continue;
    local_[at(middle)].orientation =
        given_[at(parents[at(middle)])].orientation.conjugate() * given_[at(middle)].orientation;
    local_to_world(parents, local_, solved_);
    local_[at(goal.joint)].orientation =
        solved_[at(middle)].orientation.conjugate() * given_[at(goal.joint)].orientation;
    local_to_world(parents, local_, solved_);
  }
}

// Turns joints back to where they faced, with all that hangs on them, but for what goals are for or
// relative to.
void FrameSolver::keep_upright() {
  const auto& parents = clip_.skeleton.parents;
  const Limits& limits = solver_.limits();
  for (const int joint : options_.upright) {
    const int parent = parents[at(joint)];
    const auto hangs = [&](int j) {
      while (j > joint) j = parents[at(j)];
      return j == joint;
    };
    const bool sought = std::ranges::any_of(
        active_, [&](const Goal& goal) { return hangs(goal.joint) || hangs(goal.anchor); });
    if (sought || in_chain_[at(joint)] != 0 || parent < 0) continue;
    const Quat& carrying = solved_[at(parent)].orientation;
    if (angle_between(carrying, given_[at(parent)].orientation) < 1e-9) continue;
    Quat local = carrying.conjugate() * given_[at(joint)].orientation;
    if (!limits.empty()) local = clamped(limits[at(joint)], local);
    world_to_local(parents, solved_, local_);
    local_[at(joint)].orientation = local.normalized();
    local_to_world(parents, local_, solved_);
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
    strengths_.push_back(strength_at(goal, time, duration_));
    strength = std::max(strength, strengths_.back());
  }
  if (!(strength > 0)) {
    std::ranges::fill(strengths_before_, 0.0);
    return {};
  }
  clip_.get_pose(frame - first_, given_);
  if (Status status = list_goals(time); !status) return status;
  mark_chains();
  hold();
  start_from_before();
  const auto solution = solver_.solve(active_, solved_);
  if (!solution) return solution.error();
  const Outcome* const outcome = *solution;
  bend_legs();
  list_turns(mean_);
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    if (strengths_[g] > 0 && !fades_by_turns(g)) turns_[g] = mean_;
  }
  keep_upright();
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
  result.set_pose(frame - first_, solved_);
  std::size_t next = 0;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    report[g] = {frame, strengths_[g], {}};
    if (strengths_[g] > 0) report[g].residual = missed[next++];
  }
  return {};
}

// Frames in a row in which goals are active, both included.
struct Stretch {
  int first = 0, last = 0;
};

// Of a joint relative to its parent, over the frames so far.
struct JointTurns {
  double largest = 0, before = 0;  // radians a frame, of the result and of the input
  int frame = -1;
  bool changed = false;
  Quat last = Quat::Identity(), last_before = Quat::Identity();  // in the last frame
};

// Solves a take block by block.
class BlockSolver {
 public:
  BlockSolver(const FrameSource& source, std::span<const KeyedGoal> goals, Limits limits,
              GoalMotionOptions options, int block_frames)
      : parents_(source.skeleton.parents),
        rate_(source.rate),
        duration_(source.duration()),
        goals_(goals),
        limits_(std::move(limits)),
        options_(std::move(options)),
        block_frames_(block_frames),
        joints_(parents_.size()) {
    motion_->goals.resize(goals.size());
    motion_->shifts.resize(parents_.size());
  }

  const std::shared_ptr<GoalMotion>& motion() const { return motion_; }

  // Blocks have no overlap; each comes first after those before it.
  Status change(FrameRun& run) {
    const int first = run.first, end = run.first + run.clip.frame_count();
    const auto number = at(first / block_frames_);
    before_.resize(std::max(before_.size(), number + 2));
    const std::vector<Stretch> stretches = stretches_of(first, end);
    const std::size_t count = goals_.size();
    std::vector<GoalFrame> report(at(end - first) * count);
    std::vector<Status> failed(stretches.size());
    std::vector<double> excesses(stretches.size(), 0.0);
    Clip made = run.clip;
    parallel_for(stretches.size(), 1, options_.jobs, [&](std::size_t from, std::size_t to) {
      for (std::size_t s = from; s < to; ++s) {
        const Stretch& stretch = stretches[s];
        FrameSolver solver(run, duration_, goals_, options_,
                           *Solver::create(parents_, limits_, options_.solver),
                           stretch.first == first ? before_[number] : TurnsBefore());
        for (int f = stretch.first; f <= stretch.last && failed[s].ok(); ++f) {
          failed[s] = solver.solve(f, std::span(report).subspan(at(f - first) * count, count), made,
                                   excesses[s]);
        }
        if (stretch.last + 1 == end) before_[number + 1] = std::move(solver).before();
      }
    });
    for (Status& status : failed) {
      if (!status) return std::move(status);
    }
    if (end > reported_) {
      reported_ = end;
      for (const double excess : excesses) {
        motion_->largest_excess = std::max(motion_->largest_excess, excess);
      }
      for (const Stretch& stretch : stretches)
        motion_->changed_frames += stretch.last + 1 - stretch.first;
      for (std::size_t i = 0; i < report.size(); ++i) {
        if (report[i].strength > 0) motion_->goals[i % count].push_back(report[i]);
      }
      measure_turns(run, made);
    }
    run.clip = std::move(made);
    return {};
  }

 private:
  std::vector<Stretch> stretches_of(int first, int end) const {
    std::vector<Stretch> stretches;
    for (int f = first; f < end; ++f) {
      const bool active = std::ranges::any_of(goals_, [&](const KeyedGoal& goal) {
        return strength_at(goal, f / rate_, duration_) > 0;
      });
      if (!active) continue;
      if (stretches.empty() || stretches.back().last + 1 < f) stretches.push_back({f, f});
      stretches.back().last = f;
    }
    return stretches;
  }

  void measure_turns(const FrameRun& given, const Clip& made) {
    parallel_for(parents_.size(), 1, options_.jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) measure_turns(given, made, j);
    });
    GoalMotion& motion = *motion_;
    motion.largest_turn = motion.input_turn = 0;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (!joints_[j].changed) continue;
      motion.input_turn = std::max(motion.input_turn, joints_[j].before);
      if (joints_[j].largest <= motion.largest_turn) continue;
      motion.largest_turn = joints_[j].largest;
      motion.turning_joint = static_cast<int>(j);
      motion.turning_frame = joints_[j].frame;
    }
  }

  void measure_turns(const FrameRun& given, const Clip& made, std::size_t j) {
    JointTurns& joint = joints_[j];
    GoalMotion::Shift& shift = motion_->shifts[j];
    const auto relative = [&](const Clip& of, int f) -> Quat {
      const Quat own = of.frame_orientations(f)[j].cast<double>();
      if (parents_[j] < 0) return own;
      return of.frame_orientations(f)[at(parents_[j])].cast<double>().conjugate() * own;
    };
    for (int f = 0; f < made.frame_count(); ++f) {
      const double moved = (made.frame_positions(f)[j] - given.clip.frame_positions(f)[j]).norm();
      if (moved > shift.distance) shift = {moved, given.first + f};
      const Quat was = relative(given.clip, f), now = relative(made, f);
      const Quat before = std::exchange(joint.last_before, was);
      const Quat made_before = std::exchange(joint.last, now);
      if (given.first + f == 0) continue;
      const bool is_given = now.coeffs() == was.coeffs();
      const double turn_before = angle_between(before, was);
      const double turn = is_given && made_before.coeffs() == before.coeffs()
                              ? turn_before
                              : angle_between(made_before, now);
      joint.changed = joint.changed || (!is_given && angle_between(now, was) > 1e-6);
      joint.before = std::max(joint.before, turn_before);
      if (turn > joint.largest) joint.largest = turn, joint.frame = given.first + f;
    }
  }

  const std::vector<int> parents_;
  double rate_, duration_;
  std::span<const KeyedGoal> goals_;
  const Limits limits_;
  const GoalMotionOptions options_;
  int block_frames_;
  std::vector<TurnsBefore> before_;  // at the beginning of each block
  std::vector<JointTurns> joints_;
  int reported_ = 0;  // frames that motion_ is of
  std::shared_ptr<GoalMotion> motion_ = std::make_shared<GoalMotion>();
};

}  // namespace

Result<GoalFrames> apply_goals(const FrameSource& source, std::span<const KeyedGoal> goals,
                               const Limits& limits, const GoalMotionOptions& options,
                               int block_frames) {
  const BlockSize size{std::max(block_frames, 1)};
  for (const KeyedGoal& goal : goals) {
    if (Status status = check_goal(goal, source.skeleton); !status) return status.error();
  }
  // Says now what is wrong with limits and options.
  if (auto made = Solver::create(source.skeleton.parents, limits, options.solver); !made) {
    return made.error();
  }
  const auto solver = std::make_shared<BlockSolver>(source, goals, limits, options, size.frames);
  return GoalFrames{changed_in_blocks(source, size, options.jobs,
                                      [solver](FrameRun& run) { return solver->change(run); }),
                    solver->motion()};
}

Result<GoalMotion> apply_goals(const Clip& motion, std::span<const KeyedGoal> goals,
                               const Limits& limits, const GoalMotionOptions& options) {
  const auto made = apply_goals(frames_of(motion), goals, limits, options);
  if (!made) return made.error();
  auto clip = load(made->frames, options.jobs);
  if (!clip) return clip.error();
  GoalMotion result = std::move(*made->motion);
  result.clip = *std::move(clip);
  result.clip.provenance = motion.provenance;
  return result;
}

}  // namespace krok::ik
