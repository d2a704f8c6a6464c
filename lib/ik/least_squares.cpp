#include "ik/least_squares_internal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/index.h"
#include "ik/tree_internal.h"
#include "math/quaternion.h"

namespace krok::ik {

void NormalEquations::reset(int rows) {
  rows_ = static_cast<std::size_t>(rows);
  upper_.assign(rows_ * rows_, 0.0);
  factor_.resize(rows_ * rows_);
}

void NormalEquations::add(double w, const double* column, int first, int last) {
  const auto end = static_cast<std::size_t>(last);
  for (auto i = static_cast<std::size_t>(first); i < end; ++i) {
    const double scaled = w * column[i];
    double* __restrict const row = upper_.data() + i * rows_;
    for (std::size_t k = i; k < end; ++k) row[k] += scaled * column[k];
  }
}

void NormalEquations::solve(double damping, const double* e, double* y) {
  // U^T D U by rows, so that the inner loops run along memory; e is carried along.
  const std::size_t n = rows_;
  std::copy(upper_.begin(), upper_.end(), factor_.begin());
  std::copy_n(e, n, y);
  for (std::size_t k = 0; k < n; ++k) {
    double* __restrict const pivot_row = factor_.data() + k * n;
    pivot_row[k] += damping;
    const double inverse = 1 / pivot_row[k];
    for (std::size_t i = k + 1; i < n; ++i) {
      if (pivot_row[i] == 0) continue;
      const double part = pivot_row[i] * inverse;
      double* __restrict const row = factor_.data() + i * n;
      for (std::size_t c = i; c < n; ++c) row[c] -= part * pivot_row[c];
      y[i] -= part * y[k];
    }
    pivot_row[k] = inverse;
  }
  for (std::size_t k = n; k-- > 0;) {
    const double* const row = factor_.data() + k * n;
    double sum = y[k];
    for (std::size_t c = k + 1; c < n; ++c) sum -= row[c] * y[c];
    y[k] = sum * row[k];
  }
}

namespace {

// SplitMix64 (Steele, Lea and Flood 2014): the same numbers on every machine.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream)
      : state_(seed * 0x9E3779B97F4A7C15u + stream * 0xD1B54A32D192ED03u) {}

  // In [0, 1).
  double unit() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * unit(); }

 private:
  std::uint64_t state_;
};

// Turns a joint for another start: a hinge to anywhere in its range, others by up to a radian about
// each axis, within their limits.
void turn_at_random(ChainJoint& joint, Random& random) {
  if (joint.is_hinge()) {
    joint.set_twist(random.between(joint.limit->min_twist, joint.limit->max_twist));
    return;
  }
  const Vec3 turn(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  joint.set_local((joint.local * from_rotation_vector(turn)).normalized());
}

// Largest turn of a joint in one step, beyond which the derivatives mean nothing.
constexpr double kLargestTurn = 1.0;

// A step that lowers the error by less than this part is no progress; so many in a row, and a
// local minimum is near.
constexpr double kSlow = 0.02;
constexpr int kSlowSteps = 4;
// The same for the last descent, from the best that was found: goals that cannot be reached are
// come as near to as can be.
constexpr double kSettledPart = 1e-7;

constexpr double kBias = 1e-9;

template <typename State>
void keep(const Tree& tree, State& state) {
  state.turns.resize(tree.joints.size());
  for (std::size_t j = 0; j < tree.joints.size(); ++j) {
    state.turns[j] = {tree.joints[j].local, tree.joints[j].twist};
  }
  if (tree.shifted >= 0) state.offset = tree.joints[at(tree.shifted)].offset;
}

template <typename State>
void restore(Tree& tree, const State& state) {
  for (std::size_t j = 0; j < tree.joints.size(); ++j) {
    tree.joints[j].local = state.turns[j].local;
    tree.joints[j].twist = state.turns[j].twist;
  }
  if (tree.shifted >= 0) tree.joints[at(tree.shifted)].offset = state.offset;
}

}  // namespace

void LeastSquares::list_columns(const Tree& tree) {
  columns_.clear();
  turnings_.clear();
  for (std::size_t j = 0; j < tree.joints.size(); ++j) {
    const ChainJoint& joint = tree.joints[j];
    const bool shifts = static_cast<int>(j) == tree.shifted && joint.weight > 0;
    if (!joint.moves && !shifts) continue;
    int first_row = tree.rows, last_row = 0;
    for (const GoalRows& goal : tree.goals) {
      const auto begin = tree.path.begin() + goal.first_reach, end = begin + goal.reaches;
      if (std::find(begin, end, static_cast<int>(j)) == end) continue;
      first_row = std::min(first_row, goal.row);
      last_row = std::max(last_row, goal.row + goal.rows);
    }
    Column column;
    column.freedom.joint = static_cast<int>(j);
    column.first_row = first_row;
    column.last_row = last_row;
    if (joint.moves) {
      const int count = joint.is_hinge() ? 1 : 3;
      turnings_.push_back({static_cast<int>(j), static_cast<int>(columns_.size()), count, 0});
      column.weight = joint.mobility;
      for (int i = 0; i < count; ++i) columns_.push_back(column);
    }
    if (shifts) {
      column.freedom.shift = true;
      column.weight = joint.weight;
      for (int i = 0; i < 3; ++i) {
        column.freedom.local = column.freedom.world = Vec3::Unit(i);
        columns_.push_back(column);
      }
    }
  }
  const auto rows = at(tree.rows);
  stride_ = rows;
  constexpr std::size_t kManyRows = 64;  // below, both are quick
  by_columns_ = !selective_ && rows > std::max(columns_.size(), kManyRows);
  entries_.resize(columns_.size() * stride_);
  for (auto* list : {&errors_, &tried_, &right_side_, &multipliers_}) list->assign(rows, 0.0);
}

void LeastSquares::fill_columns(Tree& tree) {
  for (Turning& turning : turnings_) {
    const ChainJoint& joint = tree.joints[at(turning.joint)];
    turning.fixed = 0;
    const Vec3 pull =
        pull_part_ > 0 ? Vec3(pull_part_ * rotation_vector(joint.local.conjugate() * joint.start))
                       : Vec3(Vec3::Zero());
    const Mat3 axes = joint.world.orientation.toRotationMatrix();
    for (int i = 0; i < turning.count; ++i) {
      Column& column = columns_[at(turning.first + i)];
      column.freedom.local = joint.is_hinge() ? joint.limit->axis : Vec3(Vec3::Unit(i));
      column.freedom.world = joint.is_hinge() ? Vec3(axes * joint.limit->axis) : Vec3(axes.col(i));
      column.pull = pull.dot(column.freedom.local);
    }
  }
  std::fill(entries_.begin(), entries_.end(), 0.0);
  for (const GoalRows& goal : tree.goals) {
    // Columns lie in the order of joints, those that a goal depends on from the last one up.
    std::size_t c = columns_.size();
    for (int i = 0; i < goal.reaches; ++i) {
      const int joint = tree.path[at(goal.first_reach + i)];
      while (c > 0 && columns_[c - 1].freedom.joint > joint) --c;
      for (; c > 0 && columns_[c - 1].freedom.joint == joint; --c) {
        tree.column(goal, columns_[c - 1].freedom, entries(c - 1));
      }
    }
  }
  if (by_columns_) return;
  equations_.reset(tree.rows);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    equations_.add(columns_[c].weight, entries(c), columns_[c].first_row, columns_[c].last_row);
  }
}

// The same step from fewer equations, if there are more rows than columns: with the error and the
// pull as below, turn = pull + (J^T J + damping W^-1)^-1 J^T (e - J pull), each column and its
// unknown scaled by the root of its weight.
void LeastSquares::solve_by_columns(double damping) {
  free_.clear();
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    Column& column = columns_[c];
    if (column.fixed) continue;
    column.turn = column.pull;
    if (column.weight > 0) free_.push_back(c);
  }
  const std::size_t n = free_.size();
  // Of these only the first are used, [columns].
  std::vector<double>&right = tried_, &turns = multipliers_;
  working_.reset(static_cast<int>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const Column& one = columns_[free_[i]];
    const double* const entry = entries(free_[i]);
    right[i] = 0;
    for (int r = one.first_row; r < one.last_row; ++r) right[i] += entry[r] * right_side_[at(r)];
    right[i] *= std::sqrt(one.weight);
    for (std::size_t k = i; k < n; ++k) {
      const Column& other = columns_[free_[k]];
      const double* const entry_of_other = entries(free_[k]);
      const int end = std::min(one.last_row, other.last_row);
      double sum = 0;
      for (int r = std::max(one.first_row, other.first_row); r < end; ++r) {
        sum += entry[r] * entry_of_other[r];
      }
      working_.upper(i, k) = std::sqrt(one.weight * other.weight) * sum;
    }
  }
  working_.solve(damping, right.data(), turns.data());
  for (std::size_t i = 0; i < n; ++i) {
    columns_[free_[i]].turn += std::sqrt(columns_[free_[i]].weight) * turns[i];
  }
}

// Takes a column that is fixed now out of the equations.
void LeastSquares::hold(std::size_t column) {
  const Column& one = columns_[column];
  if (by_columns_) return;  // they are made anew
  working_.add(-one.weight, entries(column), one.first_row, one.last_row);
}

// The step for the columns that are not fixed: turn = pull + W J^T (J W J^T + damping)^-1 (e - J
// pull), where what fixed ones do is taken off the error.
void LeastSquares::solve_step(const Tree& tree, double damping) {
  right_side_ = errors_;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    const double known = column.fixed ? column.turn : column.pull;
    if (known == 0) continue;
    const double* const entry = entries(c);
    for (int r = column.first_row; r < column.last_row; ++r) {
      right_side_[at(r)] -= known * entry[r];
    }
  }
  if (selective_) return solve_selectively(tree, damping);
  if (by_columns_) return solve_by_columns(damping);
  working_.solve(damping, right_side_.data(), multipliers_.data());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    Column& column = columns_[c];
    if (column.fixed) continue;
    const double* const entry = entries(c);
    double sum = 0;
    for (int r = column.first_row; r < column.last_row; ++r) sum += entry[r] * multipliers_[at(r)];
    column.turn = column.pull + column.weight * sum;
  }
}

Vec3 LeastSquares::turn_of(const Turning& turning) const {
  Vec3 turn = Vec3::Zero();
  for (int i = 0; i < turning.count; ++i) {
    const Column& column = columns_[at(turning.first + i)];
    turn += column.turn * column.freedom.local;
  }
  return turn;
}

bool LeastSquares::fix_hinge(const ChainJoint& joint, Turning& turning) {
  Column& column = columns_[at(turning.first)];
  const JointLimit& limit = *joint.limit;
  if (limit.max_twist - limit.min_twist >= 2 * kPi) return false;
  const double now = joint.twist;
  const double bounded = std::clamp(now + column.turn, limit.min_twist, limit.max_twist);
  if (std::abs(bounded - now - column.turn) < 1e-12) return false;
  column.turn = bounded - now;
  column.fixed = true;
  turning.fixed = 1;
  hold(at(turning.first));
  return true;
}

// Turns the columns that are still free so that the last of them is along `normal`, and fixes it at
// its part of `wanted`.
bool LeastSquares::fix_along(Turning& turning, const Vec3& normal, const Vec3& wanted) {
  const int free = turning.count - turning.fixed;
  Vec3 along = Vec3::Zero();
  for (int i = 0; i < free; ++i) {
    const Vec3& axis = columns_[at(turning.first + i)].freedom.local;
    along += axis * axis.dot(normal);
  }
  if (!(along.norm() > 1e-3 * normal.norm()) || free == 0) return false;
  along.normalize();
  // Householder's reflection of the free axes takes the last one to -+along.
  const Vec3 last = columns_[at(turning.first + free - 1)].freedom.local;
  const double sign = last.dot(along) < 0 ? 1.0 : -1.0;
  const Vec3 mirror = last - sign * along;
  const double square = mirror.squaredNorm();
  if (square > 1e-20) {
    double part[3] = {0, 0, 0};
    for (int i = 0; i < free; ++i) {
      part[i] = columns_[at(turning.first + i)].freedom.local.dot(mirror);
    }
    const Column& range = columns_[at(turning.first)];
    for (int r = range.first_row; r < range.last_row; ++r) {
      double sum = 0;
      for (int i = 0; i < free; ++i) sum += part[i] * entries(at(turning.first + i))[r];
      for (int i = 0; i < free; ++i) {
        entries(at(turning.first + i))[r] -= 2 * part[i] * sum / square;
      }
    }
    Vec3 pull = Vec3::Zero();
    for (int i = 0; i < free; ++i) {
      const Column& column = columns_[at(turning.first + i)];
      pull += column.pull * column.freedom.local;
    }
    for (int i = 0; i < free; ++i) {
      Column& column = columns_[at(turning.first + i)];
      column.freedom.local -= (2 * part[i] / square) * mirror;
      column.pull = pull.dot(column.freedom.local);
    }
  }
  const auto c = at(turning.first + free - 1);
  Column& fixed = columns_[c];
  fixed.fixed = true;
  fixed.turn = wanted.dot(fixed.freedom.local);
  hold(c);
  ++turning.fixed;
  return true;
}

bool LeastSquares::fix_cone(const ChainJoint& joint, Turning& turning) {
  const JointLimit& limit = *joint.limit;
  const Quat next = joint.local * from_rotation_vector(turn_of(turning));
  const LimitAngles angles = measure(limit, next);
  const bool twists =
      angles.twist < limit.min_twist - 1e-9 || angles.twist > limit.max_twist + 1e-9;
  const auto nearest = nearest_swing(limit, angles.swing);
  const bool swings = std::abs(nearest[0] - angles.swing[0]) > 1e-9 ||
                      std::abs(nearest[1] - angles.swing[1]) > 1e-9;
  if (!twists && !swings) return false;
  const Quat allowed =
      compose(limit, std::clamp(angles.twist, limit.min_twist, limit.max_twist), nearest);
  const Vec3 wanted = rotation_vector(joint.local.conjugate() * allowed);
  const LimitGradients normals = gradients(limit, allowed);
  bool fixed = false;
  if (twists) fixed = fix_along(turning, normals.twist, wanted);
  if (swings) fixed = fix_along(turning, normals.swing, wanted) || fixed;
  return fixed;
}

bool LeastSquares::fix_at_limits(const Tree& tree) {
  bool any = false;
  for (Turning& turning : turnings_) {
    if (turning.fixed == turning.count) continue;
    const ChainJoint& joint = tree.joints[at(turning.joint)];
    if (joint.is_hinge()) any = fix_hinge(joint, turning) || any;
    if (joint.is_cone()) any = fix_cone(joint, turning) || any;
  }
  return any;
}

void LeastSquares::find_step(const Tree& tree, double damping) {
  if (!by_columns_) working_ = equations_;
  for (Column& column : columns_) column.fixed = false;
  for (Turning& turning : turnings_) turning.fixed = 0;
  // Each round fixes what would pass a limit. More than two gain nothing: what a last solution
  // still takes beyond a limit is clamped as the step is taken, and fixed in the next one.
  for (int round = 0; round < 2; ++round) {
    solve_step(tree, damping);
    if (!fix_at_limits(tree)) return;
  }
  solve_step(tree, damping);
}

void LeastSquares::take_step(Tree& tree, double scale) const {
  for (const Turning& turning : turnings_) {
    ChainJoint& joint = tree.joints[at(turning.joint)];
    if (joint.is_hinge()) {
      joint.set_twist(joint.twist + scale * columns_[at(turning.first)].turn);
    } else {
      joint.set_local((joint.local * from_rotation_vector(scale * turn_of(turning))).normalized());
    }
  }
  for (const Column& column : columns_) {
    if (!column.freedom.shift) continue;
    ChainJoint& joint = tree.joints[at(column.freedom.joint)];
    Vec3 shift = column.freedom.world;
    if (joint.parent >= 0) {
      shift = tree.joints[at(joint.parent)].world.orientation.conjugate() * shift;
    }
    joint.offset += scale * column.turn * shift;
  }
  tree.forward();
}

int LeastSquares::descend(Tree& tree, const Options& options, int most, double slow_part) {
  error_ = tree.errors(errors_);
  if (tree.reached(errors_, options)) return 0;
  double factor = 1;
  int slow = 0;
  int iteration = 0;
  while (iteration < most) {
    ++iteration;
    fill_columns(tree);
    // Less from step to step, so that it does not keep goals from being met exactly.
    pull_part_ *= 0.5;
    find_step(tree, factor * (selective_ ? 1.0 : 0.5 * error_ + kBias));
    double largest = 0;
    for (const Turning& turning : turnings_) largest = std::max(largest, turn_of(turning).norm());
    keep(tree, kept_);
    take_step(tree, largest > kLargestTurn ? kLargestTurn / largest : 1.0);
    const double error = tree.errors(tried_);
    if (!(error < error_)) {
      restore(tree, kept_);
      tree.forward();
      factor = selective_ ? 0.1 * std::min(1.0, factor) : 8 * factor;
      if (++slow >= kSlowSteps) break;
      continue;
    }
    slow = error > (1 - slow_part) * error_ ? slow + 1 : 0;
    error_ = error;
    std::swap(errors_, tried_);
    factor = selective_ ? 4 * factor : std::max(1e-3, factor * 0.25);
    if (tree.reached(errors_, options) || slow >= kSlowSteps) break;
  }
  return iteration;
}

int LeastSquares::solve(Tree& tree, const Options& options, int& starts) {
  selective_ = options.method == Method::selectively_damped;
  list_columns(tree);
  starts = 1;
  int iterations = 0;
  if (columns_.empty() || tree.rows == 0) return iterations;
  keep(tree, first_);
  pull_part_ = options.rest_pull;
  int best_iterations = descend(tree, options, options.iterations, kSlow);
  iterations += best_iterations;
  if (tree.reached(errors_, options)) return iterations;
  double best = error_;
  keep(tree, best_);
  for (int restart = 1; restart <= options.restarts; ++restart) {
    ++starts;
    restore(tree, first_);
    Random random(options.seed, static_cast<std::uint64_t>(restart));
    for (const Turning& turning : turnings_) {
      ChainJoint& joint = tree.joints[at(turning.joint)];
      turn_at_random(joint, random);
    }
    tree.forward();
    pull_part_ = options.rest_pull;
    const int made = descend(tree, options, options.iterations, kSlow);
    iterations += made;
    if (tree.reached(errors_, options)) return iterations;
    if (error_ < best) {
      best = error_;
      best_iterations = made;
      keep(tree, best_);
    }
  }
  restore(tree, best_);
  tree.forward();
  pull_part_ = 0;
  // Out of reach selective damping comes near quickly and then wanders about the nearest pose.
  const int left = selective_ ? options.iterations : options.iterations - best_iterations;
  selective_ = false;
  return iterations + descend(tree, options, left, kSettledPart);
}

}  // namespace krok::ik
