#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

namespace krok::settling {

// Least squares for a step of values over time, [frames][size], whose second differences count as
// errors, too: normal equations of a block for each frame, tied to the two frames before.
class SmoothSystem {
 public:
  SmoothSystem(int frames, Eigen::Index size);

  // The equations of a frame, to which errors of its own are added: J^T J and J^T error.
  Eigen::MatrixXd& matrix(int frame) { return matrix_[static_cast<std::size_t>(frame)]; }
  Eigen::VectorXd& right(int frame) { return right_[static_cast<std::size_t>(frame)]; }

  void clear();

  // The step of each frame, [frames], from `values` [before + frames], of which the first `before`
  // (0 to 2) stay. `bend` is the weight of squared second differences, [size]. Solved by a block
  // Cholesky decomposition in time linear in the frames. Equations of frames must leave nothing
  // open.
  const std::vector<Eigen::VectorXd>& solve(std::span<const Eigen::VectorXd> values, int before,
                                            const Eigen::VectorXd& bend);

 private:
  std::vector<Eigen::MatrixXd> matrix_, one_before_, two_before_;
  std::vector<Eigen::VectorXd> right_;
  Eigen::Index size_;
};

}  // namespace krok::settling
