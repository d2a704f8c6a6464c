#include "rbf/weight_function.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "core/numbers.h"
#include "math/dense_solve.h"
#include "rbf/evaluate_internal.h"
#include "rbf/sobol.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"
#include "rbf/weight_system_internal.h"

namespace krok::rbf {

namespace {

constexpr std::string_view kNames[] = {"cubic", "linear", "gaussian", "bspline", "wendland"};

// Max error of the sums of a file's numbers, relative to the largest number.
constexpr double kSumTolerance = 1e-9;

// Whether each row of `columns` numbers has the right sum: `first` for row 0, else `others`.
bool sums_are(std::span<const double> rows, std::size_t columns, double first, double others) {
  for (std::size_t r = 0; r * columns < rows.size(); ++r) {
    double sum = 0, largest = 1;
    for (const double value : rows.subspan(r * columns, columns)) {
      sum += value;
      largest = std::max(largest, std::abs(value));
    }
    if (!(std::abs(sum - (r == 0 ? first : others)) <= kSumTolerance * largest)) return false;
  }
  return true;
}

Status check_counts(const WeightFunction& f) {
  if (static_cast<std::size_t>(f.kernel) >= std::size(kNames)) {
    return Error("rbf-kernel", "unknown kernel");
  }
  if (f.dimensions < 1 || f.dimensions > kMaxDimensions) {
    return Error("rbf-dimensions",
                 fmt::format("a weight function cannot have {} parameters", f.dimensions),
                 fmt::format("1 to {} are allowed", kMaxDimensions));
  }
  if (f.examples < f.dimensions + 1 || f.examples > kMaxExamples) {
    return Error(
        "rbf-examples",
        fmt::format("a weight function cannot have {} examples for {} parameters", f.examples,
                    f.dimensions),
        fmt::format("at least one more than parameters, and at most {}, are needed", kMaxExamples));
  }
  const auto d = static_cast<std::size_t>(f.dimensions);
  if (f.centres.size() % d != 0 || f.centres.size() / d < static_cast<std::size_t>(f.examples) ||
      f.centres.size() / d > kMaxCentres) {
    return Error(
        "rbf-centres",
        fmt::format("invalid centres: {} numbers for {} examples with {} parameters",
                    f.centres.size(), f.examples, f.dimensions),
        fmt::format("each example is a centre; at most {} centres are allowed", kMaxCentres));
  }
  return {};
}

Status check_shapes(const WeightFunction& f) {
  const auto d = static_cast<std::size_t>(f.dimensions);
  const auto n = static_cast<std::size_t>(f.examples);
  const auto centres = static_cast<std::size_t>(f.centre_count());
  const struct {
    const char* name;
    std::span<const double> values;
    std::size_t size;
  } arrays[] = {{"lower bounds", f.lower, d},
                {"upper bounds", f.upper, d},
                {"centres", f.centres, centres * d},
                {"radii", f.radii, has_radii(f.kernel) ? centres : 0},
                {"rows of inserted points", f.inserted_rows, (centres - n) * n},
                {"affine coefficients", f.affine, (d + 1) * n},
                {"coefficients", f.coefficients, centres * n}};
  for (const auto& array : arrays) {
    if (array.values.size() != array.size) {
      return Error("rbf-shape",
                   fmt::format("a weight function has {} numbers in its {}, expected {}",
                               array.values.size(), array.name, array.size));
    }
    if (!detail::all_finite(array.values)) {
      return Error("rbf-number",
                   fmt::format("the {} of a weight function contain NaN or infinity", array.name));
    }
  }
  return {};
}

}  // namespace

std::string_view kernel_name(Kernel kernel) {
  return kNames[static_cast<std::size_t>(kernel)];
}

std::optional<Kernel> kernel_named(std::string_view name) {
  const auto at = std::ranges::find(kNames, name);
  if (at == std::end(kNames)) return {};
  return static_cast<Kernel>(at - std::begin(kNames));
}

bool has_radii(Kernel kernel) {
  return kernel != Kernel::cubic && kernel != Kernel::linear;
}

void WeightFunction::scale(std::span<const double> point, std::span<double> scaled) const {
  for (std::size_t i = 0; i < lower.size(); ++i) {
    scaled[i] = (point[i] - lower[i]) * (1 / (upper[i] - lower[i]));
  }
}

Status WeightFunction::check() const {
  if (Status status = check_counts(*this); !status) return status;
  if (Status status = check_shapes(*this); !status) return status;
  for (std::size_t i = 0; i < lower.size(); ++i) {
    if (!(upper[i] > lower[i]) || !std::isfinite(1 / (upper[i] - lower[i])) ||
        !std::isfinite(upper[i] - lower[i])) {
      return Error("rbf-bounds",
                   fmt::format("invalid range of parameter {}: {} to {}", i + 1, readable(lower[i]),
                               readable(upper[i])),
                   "leave out parameters that are the same in all examples");
    }
  }
  for (const double radius : radii) {
    if (!(radius > 0) || !std::isfinite(1 / (radius * radius))) {
      return Error("rbf-radius", fmt::format("invalid radius {} of a centre", readable(radius)));
    }
  }
  if (!(smoothing >= 0) || !std::isfinite(smoothing)) {
    return Error("rbf-number", fmt::format("invalid smoothing {}", readable(smoothing)),
                 "it must be 0 or more");
  }
  const auto n = static_cast<std::size_t>(examples);
  if (!sums_are(affine, n, 1, 0) || !sums_are(coefficients, n, 0, 0) ||
      !sums_are(inserted_rows, n, 1, 1)) {
    return Error("rbf-sum", "the weights of a weight function do not sum to 1");
  }
  return {};
}

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

namespace {

constexpr double kStep = 0.01;  // of the range, in each direction

void take(std::span<const double> weights, WeightMetrics& metrics) {
  const auto [least, largest] = std::ranges::minmax(weights);
  metrics.least = std::min(metrics.least, least);
  metrics.largest = std::max(metrics.largest, largest);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  metrics.sum_error = std::max(metrics.sum_error, std::abs(sum - 1));
}

}  // namespace

Result<WeightMetrics> weight_metrics(const WeightFunction& function, int points,
                                     const Inside& inside) {
  auto evaluator = WeightEvaluator::create(function);
  if (!evaluator) return evaluator.error();
  const auto d = static_cast<std::size_t>(function.dimensions);
  const auto n = static_cast<std::size_t>(function.examples);
  WeightMetrics metrics;
  std::vector<double> point(d), weights(n), below(d * n), above(d * n);
  for (int k = 0; k < function.centre_count(); ++k) {
    evaluator->weights(function.centre(k), weights);
    take(weights, metrics);
  }
  const std::vector<double> all = points_inside(function, points, 0, inside);
  double sum = 0;
  for (std::size_t p = 0; p * d < all.size(); ++p) {
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(p * d), d, point.begin());
    evaluator->weights(point, weights);
    take(weights, metrics);
    for (std::size_t a = 0; a < d; ++a) {
      const double middle = point[a];
      const double range_a = function.upper[a] - function.lower[a];
      point[a] = middle - kStep * range_a;
      evaluator->slopes(point, weights, below);
      point[a] = middle + kStep * range_a;
      evaluator->slopes(point, weights, above);
      point[a] = middle;
      for (std::size_t b = 0; b < d; ++b) {
        const double scale = (function.upper[b] - function.lower[b]) / (2 * kStep);
        for (std::size_t j = 0; j < n; ++j) {
          sum += std::pow((above[b * n + j] - below[b * n + j]) * scale, 2);
        }
      }
    }
  }
  if (!all.empty())
    metrics.roughness = sum * static_cast<double>(d) / static_cast<double>(all.size());
  return metrics;
}

}  // namespace krok::rbf
