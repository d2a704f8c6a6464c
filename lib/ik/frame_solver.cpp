#include "ik/frame_solver_internal.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.h"
#include "ik/keyed_goal_internal.h"
#include "math/quaternion.h"
#include "motion/sample.h"

namespace krok::ik {

namespace {

constexpr double kForgets = 0.25;  // seconds, of the frame before
constexpr int kFirstSolves = 20;   // each as many steps as Options::iterations at most
// A motion that is beyond its limits by so much, radians, is blended by a goal's strength alone.
constexpr double kWhollyBlended = 0.1;

}  // namespace

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
      carry_along(g, time, goal);
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

// Who walks by a place is far from it before and after: of a goal that fades, more and more is
// where it is from the body as it takes full hold, so that nobody leans towards what is out of
// reach yet.
void FrameSolver::carry_along(std::size_t g, double time, Goal& goal) const {
  if (!carried_[g]) return;
  const bool fades_in = time < full_strength(goals_[g], duration_, clip_.rate).from;
  const Transform& then = (*carried_[g])[fades_in ? 0 : 1];
  const Transform& now = given_[at(solver_.options().moving_joint)];
  goal.target += (1 - strengths_[g]) * (now * (then.inverse() * goal.target) - goal.target);
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
    strengths_.push_back(strength_at(goal, time, duration_, clip_.rate));
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

}  // namespace krok::ik
