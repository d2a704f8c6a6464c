#include "rbf/weight_solver.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "math/dense_solve.h"
#include "rbf/evaluate_internal.h"
#include "rbf/weight_system_internal.h"

namespace krok::rbf {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Parameters scaled by the ranges of the examples, a column for each point.
MatrixXd scaled(const MatrixXd& examples, const MatrixXd& points) {
  const VectorXd low = examples.rowwise().minCoeff();
  const VectorXd range = examples.rowwise().maxCoeff() - low;
  return (points.colwise() - low).array().colwise() / range.array();
}

// 1, q for each point, [(d + 1) x points].
MatrixXd affine_parts(const MatrixXd& places) {
  MatrixXd parts(places.rows() + 1, places.cols());
  parts.row(0).setOnes();
  parts.bottomRows(places.rows()) = places;
  return parts;
}

// The kernels of the centres at points, [centres x points].
MatrixXd kernels(Kernel kernel, const MatrixXd& centres, const VectorXd& inverse_squares,
                 const MatrixXd& places) {
  MatrixXd values(centres.cols(), places.cols());
  for (Index p = 0; p < places.cols(); ++p) {
    for (Index k = 0; k < centres.cols(); ++k) {
      const double square = (places.col(p) - centres.col(k)).squaredNorm();
      values(k, p) = detail::basis_scalar(kernel, square, inverse_squares[k]).value;
    }
  }
  return values;
}

// Squares of the distances to the nearest other centre.
VectorXd nearest_squares(const MatrixXd& centres) {
  VectorXd nearest = VectorXd::Constant(centres.cols(), std::numeric_limits<double>::infinity());
  for (Index k = 0; k < centres.cols(); ++k) {
    for (Index i = 0; i < k; ++i) {
      const double square = (centres.col(k) - centres.col(i)).squaredNorm();
      nearest[k] = std::min(nearest[k], square);
      nearest[i] = std::min(nearest[i], square);
    }
  }
  return nearest;
}

Result<MatrixXd> solved(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd x = solve_square(a, b);
  const double residual = (a * x - b).cwiseAbs().maxCoeff();
  if (residual <= WeightSolver::kResidual) return x;
  return Error("rbf-conditioning", "the system is nearly singular",
               "leave out points that are close together, or use another kernel");
}

// The function at a point is (phi, 1, q) A^-1 (I, 0) with the saddle-point matrix A, which is
// symmetric: the solution of A z = (phi, 1, q) begins with the weights.
Result<MatrixXd> by_saddle_point(MatrixXd phi, const MatrixXd& planes, const MatrixXd& phi_there,
                                 const MatrixXd& planes_there) {
  const Index n = phi.rows(), affine = planes.rows();
  MatrixXd a = MatrixXd::Zero(n + affine, n + affine);
  a.topLeftCorner(n, n) = phi;
  a.bottomLeftCorner(affine, n) = planes;
  a.topRightCorner(n, affine) = planes.transpose();
  MatrixXd b(n + affine, phi_there.cols());
  b << phi_there, planes_there;
  auto z = solved(a, b);
  if (!z) return z.error();
  return MatrixXd(z->topRows(n));
}

// The planes are fitted to the weights of the examples first, the kernels to what remains.
Result<MatrixXd> by_remainder(const MatrixXd& phi, const MatrixXd& planes,
                              const MatrixXd& phi_there, const MatrixXd& planes_there) {
  const Index n = phi.rows();
  const MatrixXd fitted = solve_least_squares(planes.transpose(), MatrixXd::Identity(n, n));
  const auto y = solved(phi, phi_there);
  if (!y) return y.error();
  return MatrixXd(*y + fitted.transpose() * (planes_there - planes * *y));
}

}  // namespace

Result<std::vector<double>> point_weights(int dimensions, std::span<const double> parameters,
                                          Kernel kernel, double smoothing,
                                          std::span<const double> points) {
  const Index d = dimensions, n = static_cast<Index>(parameters.size()) / d;
  if (n < d + 1) return Error("rbf-examples", "there are fewer examples than parameters and one");
  const MatrixXd examples = MatrixXd::Map(parameters.data(), d, n);
  const MatrixXd asked = MatrixXd::Map(points.data(), d, static_cast<Index>(points.size()) / d);
  const MatrixXd centres = scaled(examples, examples), places = scaled(examples, asked);
  const VectorXd nearest = nearest_squares(centres);
  if (!(nearest.minCoeff() >= detail::kMinDistance * detail::kMinDistance)) {
    return Error("rbf-duplicate", "two examples have the same parameters");
  }
  VectorXd inverse_squares = VectorXd::Ones(n);
  if (has_radii(kernel)) {
    const double factor = detail::radius_factor(kernel);
    inverse_squares = (nearest * factor * factor).cwiseInverse();
  }
  // Of the transposed system: centre k in row k.
  MatrixXd phi = kernels(kernel, centres, inverse_squares, centres);
  phi.diagonal().array() += kernel == Kernel::linear ? -smoothing : smoothing;
  const MatrixXd phi_there = kernels(kernel, centres, inverse_squares, places);
  const MatrixXd planes = affine_parts(centres), planes_there = affine_parts(places);
  const auto weights = has_radii(kernel)
                           ? by_remainder(phi, planes, phi_there, planes_there)
                           : by_saddle_point(std::move(phi), planes, phi_there, planes_there);
  if (!weights) return weights.error();
  return std::vector<double>(weights->data(), weights->data() + weights->size());
}

}  // namespace krok::rbf
