#include "ik/solver.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "ik/least_squares_internal.h"
#include "ik/tree_internal.h"

namespace krok::ik {

namespace {

// How near a limit a joint counts as held by it, radians.
constexpr double kAtLimit = 1e-6;

// The directions (in the joint's frame, not unit) in which a joint at its limits cannot turn.
int outward_normals(const ChainJoint& joint, Vec3 normals[2]) {
  if (!joint.limit) return 0;
  const JointLimit& limit = *joint.limit;
  const LimitAngles angles = measure(limit, joint.local);
  int count = 0;
  const bool hinge = joint.is_hinge();
  if (limit.max_twist - limit.min_twist < 2 * kPi) {
    const Vec3 normal = hinge ? limit.axis : gradients(limit, joint.local).twist;
    if (angles.twist > limit.max_twist - kAtLimit) {
      normals[count++] = normal;
    } else if (angles.twist < limit.min_twist + kAtLimit) {
      normals[count++] = -normal;
    }
  }
  if (!hinge) {
    const auto beyond =
        std::array<double, 2>{angles.swing[0] * (1 + kAtLimit), angles.swing[1] * (1 + kAtLimit)};
    if (nearest_swing(limit, beyond) != beyond) {
      normals[count++] = gradients(limit, joint.local).swing;
    }
  }
  return count;
}

// By how much the goal's square error would fall for each radian that the joint's limit gave way.
double gain_of(const Tree& tree, const GoalRows& g, int j, const std::vector<double>& errors,
               std::vector<double>& scratch) {
  const ChainJoint& joint = tree.joints[at(j)];
  Vec3 normals[2];
  const int count = outward_normals(joint, normals);
  double best = 0;
  for (int i = 0; i < count; ++i) {
    const double length = normals[i].norm();
    if (!(length > 1e-9)) continue;
    Freedom freedom;
    freedom.joint = j;
    freedom.world = joint.world.orientation * (normals[i] / length);
    std::fill(scratch.begin(), scratch.end(), 0.0);
    tree.column(g, freedom, scratch.data());
    double gain = 0;
    for (int r = g.row; r < g.row + g.rows; ++r) gain += scratch[at(r)] * errors[at(r)];
    best = std::max(best, gain);
  }
  return best;
}

}  // namespace

void find_holding_joints(Tree& tree, std::span<Residual> residuals) {
  std::vector<double> errors(at(tree.rows), 0.0), scratch(at(tree.rows), 0.0);
  tree.errors(errors);
  for (std::size_t i = 0; i < tree.goals.size(); ++i) {
    if (residuals[i].reached) continue;
    const GoalRows& g = tree.goals[i];
    double square = 0;
    for (int r = g.row; r < g.row + g.rows; ++r) square += errors[at(r)] * errors[at(r)];
    // Less than a thousandth of the error for each radian is no help.
    double best = 1e-3 * square;
    for (int k = 0; k < g.moving; ++k) {
      const int j = tree.path[at(g.first_path + k)];
      if (!tree.joints[at(j)].moves) continue;
      const double gain = gain_of(tree, g, j, errors, scratch);
      if (gain > best) {
        best = gain;
        residuals[i].held_by = tree.joints[at(j)].index;
      }
    }
  }
}

namespace {

Status check(const Options& options, std::size_t joints) {
  const auto wrong = [](std::string what) { return Error("ik-option", std::move(what)); };
  if (!(options.distance >= 0) || !(options.angle >= 0)) {
    return wrong("the tolerances must be 0 or more");
  }
  if (options.iterations < 0 || options.restarts < 0) {
    return wrong("iterations and restarts must be 0 or more");
  }
  if (!(options.rest_pull >= 0 && options.rest_pull <= 1)) {
    return wrong("the pull to the rest pose must be from 0 to 1");
  }
  if (options.root_moves && (options.moving_joint < 0 || at(options.moving_joint) >= joints)) {
    return wrong("the joint that moves does not exist");
  }
  const auto fits = [&](std::size_t size) { return size == 0 || size == joints; };
  if (!fits(options.stiffness.size()) || !fits(options.masses.size()) ||
      !fits(options.mass_centres.size())) {
    return wrong(
        fmt::format("stiffness and masses must have one value for each of {} joints", joints));
  }
  for (const double value : options.stiffness) {
    if (!(value >= 0 && value <= 1)) return wrong("a stiffness is not from 0 to 1");
  }
  for (const double mass : options.masses) {
    if (!(mass >= 0 && mass < 1e9)) return wrong("a mass is not a number from 0");
  }
  for (const Vec3& centre : options.mass_centres) {
    if (!centre.allFinite()) return wrong("a centre of mass is not finite");
  }
  return {};
}

Status check(const Goal& goal, std::size_t index, const Tree& tree) {
  const int joints = static_cast<int>(tree.parents().size());
  const auto wrong = [&](const char* what) {
    return Error("ik-goal", fmt::format("goal {}: {}", index, what));
  };
  if (!(goal.weight > 0) || !std::isfinite(goal.weight)) return wrong("its weight is not positive");
  if (goal.depth < 0) return wrong("its depth is negative");
  if (!goal.target.allFinite() || !goal.point.allFinite() ||
      !(std::abs(goal.orientation.norm() - 1) < 1e-6) || !(std::abs(goal.axis.norm() - 1) < 1e-6)) {
    return wrong("a value is not finite, or a direction not of length 1");
  }
  for (const Vec2& corner : goal.support) {
    if (!corner.allFinite()) return wrong("a corner of the support is not finite");
  }
  if (goal.kind == Goal::Kind::balance) return {};
  if (goal.joint < 0 || goal.joint >= joints) return wrong("its joint does not exist");
  if (goal.anchor >= joints) return wrong("the joint that it is relative to does not exist");
  if (goal.kind != Goal::Kind::pole) return {};
  const auto is_above = [&](int upper, int lower) {
    while (lower > upper) lower = tree.parents()[at(lower)];
    return lower == upper;
  };
  const int upper = goal.upper >= 0 ? goal.upper : tree.parents()[at(goal.joint)];
  const int lower = goal.lower >= 0 ? goal.lower : tree.first_child(goal.joint);
  if (upper < 0 || lower < 0 || lower >= joints || upper == goal.joint || lower == goal.joint ||
      !is_above(upper, goal.joint) || !is_above(goal.joint, lower)) {
    return wrong("the pole's joint has no joint above or below it that it could bend between");
  }
  return {};
}

}  // namespace

struct Solver::State {
  Limits limits;
  Options options;
  Tree tree;
  LeastSquares least_squares;
  Outcome outcome;
};

Solver::Solver(std::unique_ptr<State> state) : state_(std::move(state)) {}
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;
Solver::~Solver() = default;

const Limits& Solver::limits() const {
  return state_->limits;
}

const Options& Solver::options() const {
  return state_->options;
}

Result<Solver> Solver::create(std::span<const int> parents, Limits limits, Options options) {
  if (Status status = ik::check(limits, static_cast<int>(parents.size())); !status) {
    return status.error();
  }
  if (Status status = check(options, parents.size()); !status) return status.error();
  auto state = std::make_unique<State>();
  state->limits = std::move(limits);
  state->options = std::move(options);
  state->tree.prepare(parents);
  return Solver(std::move(state));
}

Result<const Outcome*> Solver::solve(std::span<const Goal> goals,
                                     std::span<Transform> joint_to_world) {
  State& s = *state_;
  for (std::size_t g = 0; g < goals.size(); ++g) {
    if (Status status = check(goals[g], g, s.tree); !status) return status.error();
  }
  Outcome& outcome = s.outcome;
  outcome.goals.clear();
  outcome.iterations = 0;
  outcome.starts = 0;
  outcome.reached = true;
  if (goals.empty()) return &outcome;
  s.tree.collect(goals, s.limits, s.options, joint_to_world);
  switch (s.options.method) {
    case Method::least_squares:
    case Method::selectively_damped:
      outcome.iterations = s.least_squares.solve(s.tree, s.options, outcome.starts);
      break;
    case Method::ccd:
      outcome.iterations = solve_ccd(s.tree, s.options);
      outcome.starts = 1;
      break;
    case Method::two_bone:
      solve_limbs(s.tree, s.options);
      outcome.iterations = outcome.starts = 1;
      break;
  }
  for (const GoalRows& rows : s.tree.goals) {
    outcome.goals.push_back(s.tree.residual(rows, s.options));
    outcome.reached = outcome.reached && outcome.goals.back().reached;
  }
  if (!outcome.reached) find_holding_joints(s.tree, outcome.goals);
  s.tree.write(joint_to_world);
  return &outcome;
}

std::vector<Residual> residuals(std::span<const Goal> goals, std::span<const int> parents,
                                std::span<const Transform> joint_to_world, const Options& options) {
  Tree tree;
  tree.prepare(parents);
  tree.collect(goals, {}, options, joint_to_world);
  std::vector<Residual> result;
  for (const GoalRows& rows : tree.goals) result.push_back(tree.residual(rows, options));
  return result;
}

}  // namespace krok::ik
