#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/least_squares_internal.h"

// Method::selectively_damped: Buss and Kim, "Selectively damped least squares for inverse
// kinematics", Journal of Graphics Tools 10(3), 2005. Their names: e the errors, u, v and sigma a
// singular triple of the derivatives, N how far u moves the effectors, M how far the joints' turns
// of v / sigma would move them one by one, gamma the largest turn.

namespace krok::ik {

namespace {

// Singular values under this part of the largest are rounding errors: they come from squares.
constexpr double kLeastSingular = 1e-7;

constexpr double kWidestTurn = kPi / 4;  // theirs

}  // namespace

// The largest of the turns in `step_`, each joint's columns together.
double LeastSquares::largest_turn() const {
  double largest = 0;
  for (const Turning& turning : turnings_) {
    largest = std::max(largest, step_.segment(turning.first, turning.count).norm());
  }
  return largest;
}

// How far the joints' turns in `step_` move the effectors, joint by joint: a goal's position and
// its orientation are two effectors.
double LeastSquares::moved_apart(const Tree& tree) const {
  double sum = 0;
  for (std::size_t begin = 0, end = 0; begin < columns_.size(); begin = end) {
    while (end < columns_.size() && columns_[end].freedom.joint == columns_[begin].freedom.joint &&
           columns_[end].freedom.shift == columns_[begin].freedom.shift) {
      ++end;
    }
    for (const GoalRows& goal : tree.goals) {
      for (int row = goal.row; row < goal.row + goal.rows; row += 3) {
        Vec3 moved = Vec3::Zero();
        const int rows = std::min(3, goal.row + goal.rows - row);
        for (std::size_t c = begin; c < end; ++c) {
          const double turn = step_[static_cast<Eigen::Index>(c)];
          const double* const entry = entries_.data() + c * stride_ + at(row);
          if (turn == 0) continue;
          for (int r = 0; r < rows; ++r)
            moved[r] += turn * std::sqrt(columns_[c].weight) * entry[r];
        }
        sum += moved.norm();
      }
    }
  }
  return sum;
}

void LeastSquares::solve_selectively(const Tree& tree, double trust) {
  const double largest = kWidestTurn * std::min(1.0, trust);
  const Eigen::Index rows = tree.rows;
  const auto count = static_cast<Eigen::Index>(columns_.size());
  square_.resize(rows, rows);
  for (Eigen::Index r = 0; r < rows; ++r) {
    for (Eigen::Index c = r; c < rows; ++c) {
      square_(c, r) = working_.upper(static_cast<std::size_t>(r), static_cast<std::size_t>(c));
    }
  }
  eigen_.compute(square_);  // of its lower triangle
  const Eigen::Map<const Eigen::VectorXd> e(right_side_.data(), rows);
  sum_.setZero(count);
  step_.resize(count);
  const double most = std::sqrt(std::max(0.0, eigen_.eigenvalues()[rows - 1]));
  for (Eigen::Index i = rows; i-- > 0;) {
    const double sigma = std::sqrt(std::max(0.0, eigen_.eigenvalues()[i]));
    if (!(sigma > kLeastSingular * most)) break;
    const auto u = eigen_.eigenvectors().col(i);
    for (Eigen::Index c = 0; c < count; ++c) {
      const Column& column = columns_[static_cast<std::size_t>(c)];
      const Eigen::Map<const Eigen::VectorXd> entry(entries(static_cast<std::size_t>(c)), rows);
      step_[c] = column.fixed ? 0.0 : std::sqrt(column.weight) * entry.dot(u) / sigma;
    }
    double along = 0;
    for (const GoalRows& goal : tree.goals) {
      for (int row = 0; row < goal.rows; row += 3) {
        along += u.segment(goal.row + row, std::min(3, goal.rows - row)).norm();
      }
    }
    const double apart = moved_apart(tree) / sigma;
    const double gamma = std::min(largest, kWidestTurn * trust * along / apart);
    step_ *= u.dot(e) / sigma;
    const double turn = largest_turn();
    sum_ += (turn > gamma ? gamma / turn : 1.0) * step_;
  }
  step_ = sum_;
  const double turn = largest_turn();
  const double scale = turn > largest ? largest / turn : 1.0;
  for (Eigen::Index c = 0; c < count; ++c) {
    Column& column = columns_[static_cast<std::size_t>(c)];
    if (!column.fixed) column.turn = column.pull + scale * std::sqrt(column.weight) * step_[c];
  }
}

}  // namespace krok::ik
