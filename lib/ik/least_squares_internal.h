#pragma once

#include <Eigen/Eigenvalues>
#include <vector>

#include "ik/tree_internal.h"

namespace krok::ik {

// (sum of w c c^T + damping I) y = e: the normal equations of damped least squares, over goals'
// rows or over joints' columns, whichever are fewer. Columns c have entries in a range of rows
// alone.
class NormalEquations {
 public:
  void reset(int rows);

  // Adds w c c^T for a column with entries in [first, last); w < 0 takes one out again.
  void add(double w, const double* column, int first, int last);

  // An element of the upper triangle, row <= column.
  double& upper(std::size_t row, std::size_t column) { return upper_[row * rows_ + column]; }

  // y for the right side `e`, both [rows] and different memory. Destroys nothing: more columns may
  // be added or taken out later.
  void solve(double damping, const double* e, double* y);

 private:
  std::size_t rows_ = 0;
  std::vector<double> upper_;   // [rows x rows], the upper triangle
  std::vector<double> factor_;  // scratch
};

// Method::least_squares and selectively_damped; keeps its memory from solve to solve.
class LeastSquares {
 public:
  // From the tree's pose, and from further starts, towards the goals. Returns the iterations made;
  // `starts` is how many starts it took.
  int solve(Tree& tree, const Options& options, int& starts);

 private:
  struct Column {
    Freedom freedom;
    double weight = 0;
    double pull = 0;  // towards the start pose
    double turn = 0;  // what the step shall be
    bool fixed = false;
    int first_row = 0, last_row = 0;
  };
  // One joint's columns: turns first, three of them or one, and three shifts of the joint that
  // moves.
  struct Turning {
    int joint = 0;
    int first = 0, count = 0;
    int fixed = 0;  // the last `fixed` of them are held by limits
  };

  // The rotations of all joints of the tree, and where the one that may be shifted is.
  struct PoseState {
    struct Turn {
      Quat local;
      double twist;
    };
    std::vector<Turn> turns;
    Vec3 offset = Vec3::Zero();
  };

  // At most `most` steps, until the goals are reached or several steps in a row lower the error by
  // less than `slow_part` of it.
  int descend(Tree& tree, const Options& options, int most, double slow_part);
  void list_columns(const Tree& tree);
  void fill_columns(Tree& tree);
  void find_step(const Tree& tree, double damping);
  // `damping`: of selective steps how far their limits are trusted, 1 as published.
  void solve_step(const Tree& tree, double damping);
  void solve_by_columns(double damping);
  void solve_selectively(const Tree& tree, double trust);
  double largest_turn() const;
  double moved_apart(const Tree& tree) const;
  void hold(std::size_t column);
  bool fix_at_limits(const Tree& tree);
  bool fix_hinge(const ChainJoint& joint, Turning& turning);
  bool fix_cone(const ChainJoint& joint, Turning& turning);
  bool fix_along(Turning& turning, const Vec3& normal, const Vec3& wanted);
  void take_step(Tree& tree, double scale) const;
  Vec3 turn_of(const Turning& turning) const;
  double* entries(std::size_t column) { return entries_.data() + column * stride_; }

  std::vector<Column> columns_;
  std::vector<Turning> turnings_;
  std::vector<double> entries_;  // [columns x rows]
  std::size_t stride_ = 0;
  bool selective_ = false;         // Method::selectively_damped
  bool by_columns_ = false;        // the equations are over columns
  std::vector<std::size_t> free_;  // columns of them
  NormalEquations equations_, working_;
  std::vector<double> errors_, tried_, right_side_, multipliers_;
  PoseState kept_, best_, first_;
  // Of selective steps, scaled by the roots of weights: [columns].
  Eigen::VectorXd step_, sum_;
  Eigen::MatrixXd square_;  // [rows x rows]
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_;
  double pull_part_ = 0;  // of the way to the start pose
  double error_ = 0;
};

}  // namespace krok::ik
