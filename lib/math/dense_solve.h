#pragma once

#include <vector>

#include "math/types.h"

// Dense linear systems of a few unknowns. Eigen's decompositions take seconds to compile wherever
// they are used, so that they are used here alone. `a` has shape [rows x columns]; nothing is
// checked: what is not finite gives results that are not finite.

namespace krok {

// a x = b for a square matrix, by LU with full pivoting. A singular one gives one of its solutions,
// or the nearest thing to it.
Eigen::VectorXd solve_full_pivoting(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd inverse_full_pivoting(const Eigen::MatrixXd& a);

// The shortest x of those that bring a x nearest to b, for any shape and rank.
Eigen::VectorXd solve_minimum_norm(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

// The x that brings a x nearest to b, column by column; `a` has full column rank.
Eigen::MatrixXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
// The same with pivoting, for columns that are nearly dependent.
Eigen::MatrixXd solve_least_squares_pivoting(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// An orthonormal basis of what the columns span, [rows x columns]; rows >= columns.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& a);

// The columns in the order in which each adds most to those before it, and how many of them are
// independent: pivots below `threshold` times the largest count as none.
struct PivotedColumns {
  Eigen::Index rank = 0;
  std::vector<Eigen::Index> order;  // [columns]
};
PivotedColumns pivoted_columns(const Eigen::MatrixXd& a, double threshold);

// The rotation nearest to a matrix (Kabsch 1976: U V^T of its singular vectors); where that would
// mirror, the direction of the least singular value is turned round.
Mat3 nearest_rotation(const Mat3& a);

}  // namespace krok
