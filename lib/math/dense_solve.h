#pragma once

#include <vector>

#include "math/transform.h"

// Small dense linear systems. Eigen's decompositions take seconds to compile wherever they are
// used, so they are used only here. `a` has shape [rows x columns]. Input is not checked:
// non-finite input gives non-finite results.

namespace krok {

// Solves a x = b for a square matrix by LU with full pivoting. If `a` is singular, gives one of the
// solutions, or an approximate one if there is none.
Eigen::VectorXd solve_full_pivoting(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd inverse_full_pivoting(const Eigen::MatrixXd& a);

// Solves a x = b for a square matrix, column by column, by LU with partial pivoting: many times
// faster than full pivoting. Not finite, or off, if `a` is singular.
Eigen::MatrixXd solve_square(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The minimum-norm least-squares solution of a x = b, for any shape and rank.
Eigen::VectorXd solve_minimum_norm(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

// The least-squares solution of a x = b, column by column, with column pivoting for nearly
// dependent columns; `a` has full column rank.
Eigen::MatrixXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// An orthonormal basis of the column space, [rows x columns]; rows >= columns.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& a);

// Column order and rank by QR with column pivoting: each column adds most to the span of those
// before it. Pivots below `threshold` times the largest count as zero.
struct PivotedColumns {
  Eigen::Index rank = 0;
  std::vector<Eigen::Index> order;  // [columns]
};
PivotedColumns pivoted_columns(const Eigen::MatrixXd& a, double threshold);

// The rotation nearest to a matrix (Kabsch 1976: U V^T of its singular vectors); if that is a
// reflection, the direction of the smallest singular value is flipped.
Mat3 nearest_rotation(const Mat3& a);
// The same by the method of Newton from a rotation that is near it, several times as fast; by
// singular values where that does not converge, as for a reflection or a matrix of rank 1.
Quat nearest_rotation(const Mat3& a, const Quat& near);

}  // namespace krok
