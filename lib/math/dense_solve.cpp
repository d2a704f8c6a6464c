#include "math/dense_solve.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace krok {

Eigen::VectorXd solve_full_pivoting(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.fullPivLu().solve(b);
}

Eigen::MatrixXd inverse_full_pivoting(const Eigen::MatrixXd& a) {
  return a.fullPivLu().inverse();
}

Eigen::MatrixXd solve_square(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::VectorXd solve_minimum_norm(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

Eigen::MatrixXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& a) {
  return a.householderQr().householderQ() * Eigen::MatrixXd::Identity(a.rows(), a.cols());
}

PivotedColumns pivoted_columns(const Eigen::MatrixXd& a, double threshold) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  qr.setThreshold(threshold);
  PivotedColumns result;
  result.rank = qr.rank();
  const auto& order = qr.colsPermutation().indices();
  result.order.assign(order.data(), order.data() + order.size());
  return result;
}

Mat3 nearest_rotation(const Mat3& a) {
  const Eigen::JacobiSVD<Mat3> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  // Singular values are in decreasing order, so flipping the last direction changes least.
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

Quat nearest_rotation(const Mat3& a, const Quat& near) {
  constexpr int kSteps = 6;
  Quat turn = near;
  for (int i = 0; i < kSteps; ++i) {
    // The trace of back, turned by a small vector, to the second order.
    const Mat3 back = a * turn.conjugate().toRotationMatrix();
    const Mat3 bend = back.trace() * Mat3::Identity() - 0.5 * (back + back.transpose());
    const double minor = bend(0, 0) * bend(1, 1) - bend(0, 1) * bend(1, 0);
    if (!(bend(0, 0) > 0 && minor > 0 && bend.determinant() > 1e-9 * minor * bend.trace())) break;
    const Vec3 step = bend.inverse() * Vec3(back(2, 1) - back(1, 2), back(0, 2) - back(2, 0),
                                            back(1, 0) - back(0, 1));
    Quat by;
    by.w() = 1;
    by.vec() = 0.5 * step;
    turn = (by * turn).normalized();
    if (step.squaredNorm() < 1e-14) return turn;  // the error is its square
  }
  return Quat(nearest_rotation(a)).normalized();
}

}  // namespace krok
