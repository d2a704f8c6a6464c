#include "fit/new_rows_internal.h"

#include <ceres/ceres.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/worst_points_internal.h"

namespace krok::fit::detail {

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

constexpr int kIterations = 50;

// Orthonormal columns, orthogonal to (1, .., 1): Helmert matrix.
Matrix sum_zero_basis(Eigen::Index size) {
  Matrix basis = Matrix::Zero(size, size - 1);
  for (Eigen::Index k = 1; k < size; ++k) {
    const double length = std::sqrt(static_cast<double>(k) * static_cast<double>(k + 1));
    basis.col(k - 1).head(k).setConstant(1 / length);
    basis(k, k - 1) = -static_cast<double>(k) / length;
  }
  return basis;
}

// Residuals as functions of y: parameters, distance from the start, weights that are too negative.
class BlendCost final : public ceres::CostFunction {
 public:
  BlendCost(const rbf::Measure& measure, std::span<const double> inverse_ranges,
            std::span<const double> wanted, std::span<const double> start,
            const RefineOptions& options)
      : measure_(measure),
        scale_(Eigen::Map<const Vector>(inverse_ranges.data(), size(inverse_ranges)) /
               options.scale),
        wanted_(Eigen::Map<const Vector>(wanted.data(), size(wanted))),
        start_(Eigen::Map<const Vector>(start.data(), size(start))),
        basis_(sum_zero_basis(size(start))),
        options_(options) {
    set_num_residuals(static_cast<int>(wanted_.size() + basis_.cols() + start_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(basis_.cols()));
  }

  Vector weights_of(const double* y) const {
    return start_ + basis_ * Eigen::Map<const Vector>(y, basis_.cols());
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Index d = wanted_.size(), n = start_.size(), free = basis_.cols();
    const Vector weights = weights_of(parameters[0]);
    const bool slopes = jacobians != nullptr && jacobians[0] != nullptr;
    Vector measured(d);
    Matrix by_weights(d, slopes ? n : 0);
    const Status status =
        measure_({weights.data(), static_cast<std::size_t>(n)},
                 {measured.data(), static_cast<std::size_t>(d)},
                 {by_weights.data(), static_cast<std::size_t>(by_weights.size())});
    if (!status) return false;
    Eigen::Map<Vector> rest(residuals, num_residuals());
    rest.head(d) = scale_.cwiseProduct(measured - wanted_);
    rest.segment(d, free) = options_.stay * Eigen::Map<const Vector>(parameters[0], free);
    for (Eigen::Index i = 0; i < n; ++i) {
      rest[d + free + i] = options_.positive * std::max(0.0, -weights[i] - options_.slack);
    }
    // Ceres would print a warning about numbers that are not finite.
    if (!rest.allFinite()) return false;
    if (!slopes) return true;
    Eigen::Map<Matrix> jacobian(jacobians[0], num_residuals(), free);
    jacobian.topRows(d) = scale_.asDiagonal() * (by_weights * basis_);
    jacobian.middleRows(d, free) = options_.stay * Matrix::Identity(free, free);
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool negative = -weights[i] - options_.slack > 0;
      jacobian.row(d + free + i) = (negative ? -options_.positive : 0.0) * basis_.row(i);
    }
    return jacobian.allFinite();
  }

  // |f(w) - wanted| scaled by the ranges.
  double error_at(const Vector& weights) const {
    Vector measured(wanted_.size());
    const Status status =
        measure_({weights.data(), static_cast<std::size_t>(weights.size())},
                 {measured.data(), static_cast<std::size_t>(measured.size())}, {});
    const double error = scale_.cwiseProduct(measured - wanted_).norm() * options_.scale;
    return status.ok() && std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
  }

  bool can_begin(const double* y) const {
    std::vector<double> residuals(static_cast<std::size_t>(num_residuals()));
    std::vector<double> jacobian(residuals.size() * static_cast<std::size_t>(free()));
    double* slopes = jacobian.data();
    return Evaluate(&y, residuals.data(), &slopes);
  }

  Eigen::Index free() const { return basis_.cols(); }

 private:
  static Eigen::Index size(std::span<const double> values) {
    return static_cast<Eigen::Index>(values.size());
  }

  const rbf::Measure& measure_;
  Vector scale_, wanted_, start_;
  Matrix basis_;
  const RefineOptions& options_;
};

}  // namespace

BlendWeights solve_weights(const rbf::Measure& measure, std::span<const double> inverse_ranges,
                           std::span<const double> wanted, std::span<const double> start,
                           const RefineOptions& options) {
  BlendCost cost(measure, inverse_ranges, wanted, start, options);
  Vector y = Vector::Zero(cost.free());

  // If the first evaluation fails, Ceres prints a message even when logging is off.
  if (!cost.can_begin(y.data())) {
    return {{start.begin(), start.end()}, std::numeric_limits<double>::infinity()};
  }
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(&cost, nullptr, y.data());
  ceres::Solver::Options solving;
  solving.linear_solver_type = ceres::DENSE_QR;
  solving.num_threads = 1;
  solving.max_num_iterations = kIterations;
  solving.function_tolerance = 1e-10;
  solving.parameter_tolerance = 1e-12;
  solving.gradient_tolerance = 1e-12;
  solving.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solving, &problem, &summary);

  const Vector weights = cost.weights_of(y.data());
  return {{weights.data(), weights.data() + weights.size()}, cost.error_at(weights)};
}

namespace {

using rbf::InverseSearch;

constexpr int kSearchSteps = 30;        // for p'
constexpr double kFound = 1e-9;         // scaled error at which the search for p' stops
constexpr double kFoundWell = 1e-6;     // scaled error at which p' is accepted
constexpr double kLargeResidual = 0.1;  // relative to the error to be removed
constexpr double kLowMargin = 0.005;    // added to `lowest` as a safety margin
constexpr double kLowRow = 0.8;         // of `lowest`: new rows are penalised for weights below it
constexpr int kRowSteps = 10;           // of the correction that follows the solver

// The row nearest to the weights at the point that has the right parameters and no weight too low.
void find_low_row(const rbf::WeightEvaluator& evaluator, const rbf::Measure& measure,
                  const RefineOptions& options, Found& found) {
  RefineOptions gently = options;
  gently.slack = -kLowRow * options.lowest;
  found.row.resize(static_cast<std::size_t>(evaluator.examples()));
  evaluator.weights(found.point, found.row);
  found.row =
      solve_weights(measure, evaluator.inverse_ranges(), found.point, found.row, gently).weights;
  const double error =
      InverseSearch(evaluator, measure).correct(found.point, kRowSteps, kFound, found.row).after;
  const auto [least, largest] = std::ranges::minmax(found.row);
  if (!(error <= std::max(kFoundWell, kLargeResidual * found.sought))) {
    found.refusal = Refusal::residual;
    found.value = error;
  } else if (!(least >= low_limit(options) && largest <= options.largest)) {
    found.refusal = Refusal::weights;
    found.value = least >= low_limit(options) ? largest : least;
  }
}

}  // namespace

double low_limit(const RefineOptions& options) {
  return options.lowest + kLowMargin;
}

void find_row(const rbf::WeightSolver& solver, const rbf::WeightEvaluator& evaluator,
              const rbf::Measure& measure, const RefineOptions& options, double usual,
              Found& found) {
  const double near = solver.distance_to_centres(found.point);
  if (near < kNear * usual) {
    found.refusal = Refusal::near;
    found.value = near;
    return;
  }
  if (found.low) {
    find_low_row(evaluator, measure, options, found);
    return;
  }
  InverseSearch search(evaluator, measure);
  std::vector<double> point = found.point;
  found.row.resize(static_cast<std::size_t>(evaluator.examples()));
  double error = search.find_point(found.point, kSearchSteps, kFound, point).after;
  evaluator.weights(point, found.row);
  if (std::ranges::min(found.row) < low_limit(options)) {
    find_low_row(evaluator, measure, options, found);
    return;
  }
  const auto off = [&] {
    const auto [least, largest] = std::ranges::minmax(found.row);
    return std::max(options.least - least, largest - options.largest);
  };
  found.by_point = error <= kFoundWell && off() <= 0;
  if (!found.by_point) {
    evaluator.weights(found.point, found.row);
    BlendWeights solved =
        solve_weights(measure, evaluator.inverse_ranges(), found.point, found.row, options);
    found.row = std::move(solved.weights);
    error = solved.error;
  }
  if (!(error <= kLargeResidual * found.sought)) {
    found.refusal = Refusal::residual;
    found.value = error;
  } else if (!(off() <= 0)) {
    found.refusal = Refusal::weights;
    const auto [least, largest] = std::ranges::minmax(found.row);
    found.value = options.least - least > largest - options.largest ? least : largest;
  }
}

}  // namespace krok::fit::detail
