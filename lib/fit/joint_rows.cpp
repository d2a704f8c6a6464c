#include "fit/joint_rows_internal.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/parallel.h"
#include "fit/error_field_internal.h"

namespace krok::fit::detail {

namespace {

constexpr std::size_t kRowGrain = 16;      // points or rows per task
constexpr std::size_t kPointsAtOnce = 64;  // their weights fit into the L1 cache
constexpr double kMinGain = 1e-4;          // min relative decrease of the cost per iteration
constexpr int kMemory = 20;                // number of gradients that L-BFGS keeps
constexpr double kNothing = 1e-24;         // initial cost that counts as zero

// Projects out the component that would change the sum.
void remove_mean(std::span<double> values) {
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
}

// Cost and gradient as functions of the row changes. The Jacobian (thousands of errors by thousands
// of numbers) is never formed: both take two products with the influences.
class JointCost final : public ceres::FirstOrderFunction {
 public:
  JointCost(const JointRows& problem, const JointTerms& terms, int jobs)
      : problem_(problem),
        terms_(terms),
        jobs_(jobs),
        n_(problem.examples),
        pulls_(problem.points * n_),
        costs_(problem.points) {}

  int NumParameters() const override { return static_cast<int>(problem_.rows * n_); }

  // Costs are divided by `unit`, so that Ceres' tolerances do not depend on the size of the errors.
  void set_unit(double unit) { unit_ = unit; }

  bool Evaluate(const double* added, double* cost, double* gradient) const override {
    const std::span<const double> changes(added, problem_.rows * n_);
    parallel_for(problem_.points, kRowGrain, jobs_,
                 [&](std::size_t begin, std::size_t end) { take_points(changes, begin, end); });
    const double stay = terms_.stay * terms_.stay / static_cast<double>(problem_.rows) / unit_;
    *cost = std::accumulate(costs_.begin(), costs_.end(), 0.0);
    *cost += 0.5 * stay * std::inner_product(changes.begin(), changes.end(), changes.begin(), 0.0);
    if (gradient == nullptr) return true;
    const std::span<double> slopes(gradient, changes.size());
    parallel_for(problem_.rows, kRowGrain, jobs_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin * n_; i < end * n_; ++i) slopes[i] = stay * changes[i];
      for (std::size_t p = 0; p < problem_.points; p += kPointsAtOnce) {
        const std::size_t count = std::min(kPointsAtOnce, problem_.points - p);
        for (std::size_t k = begin; k < end; ++k) {
          add_products(&problem_.influences[p * problem_.rows + k], problem_.rows, &pulls_[p * n_],
                       count, n_, &slopes[k * n_]);
        }
      }
    });
    return true;
  }

 private:
  // Costs of points, and the gradient by their weights.
  void take_points(std::span<const double> changes, std::size_t begin, std::size_t end) const {
    std::vector<double> by(n_);  // [d], not inside, up to a quarter of the range beyond it
    const double scale = 1 / static_cast<double>(problem_.points) / unit_;
    for (std::size_t p = begin; p < end; ++p) {
      std::ranges::fill(by, 0.0);
      add_products(&problem_.influences[p * problem_.rows], 1, changes.data(), problem_.rows, n_,
                   by.data());
      const auto pull = std::span(pulls_).subspan(p * n_, n_);
      std::ranges::fill(pull, 0.0);
      double square = 0;
      for (std::size_t r = p * problem_.dimensions; r < (p + 1) * problem_.dimensions; ++r) {
        const auto slopes = std::span(problem_.slopes).subspan(r * n_, n_);
        const double error =
            std::inner_product(by.begin(), by.end(), slopes.begin(), problem_.errors[r]);
        square += error * error;
        for (std::size_t i = 0; i < n_; ++i) pull[i] += scale * error * slopes[i];
      }
      for (std::size_t i = 0; i < n_; ++i) {
        const double under =
            terms_.positive * std::max(0.0, terms_.low - problem_.weights[p * n_ + i] - by[i]);
        square += under * under;
        pull[i] -= scale * terms_.positive * under;
      }
      remove_mean(pull);
      costs_[p] = 0.5 * scale * square;
    }
  }

  const JointRows& problem_;
  const JointTerms& terms_;
  int jobs_;
  std::size_t n_;
  double unit_ = 1;
  mutable std::vector<double> pulls_, costs_;  // [points x examples], [points]
};

}  // namespace

std::vector<double> joint_changes(const JointRows& problem, const JointTerms& terms, int jobs) {
  std::vector<double> changes(problem.rows * problem.examples);
  auto* cost = new JointCost(problem, terms, jobs);  // owned by the Ceres problem
  ceres::GradientProblem gradient_problem(cost);
  double at_start = 0;
  cost->Evaluate(changes.data(), &at_start, nullptr);
  if (!(at_start > kNothing) || !std::isfinite(at_start)) return changes;
  cost->set_unit(at_start);
  ceres::GradientProblemSolver::Options solving;
  solving.line_search_direction_type = ceres::LBFGS;
  solving.max_lbfgs_rank = kMemory;
  solving.use_approximate_eigenvalue_bfgs_scaling = true;
  solving.max_num_iterations = terms.iterations;
  solving.function_tolerance = kMinGain;
  solving.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(solving, gradient_problem, changes.data(), &summary);
  for (std::size_t k = 0; k < problem.rows; ++k) {
    remove_mean(std::span(changes).subspan(k * problem.examples, problem.examples));
  }
  return changes;
}

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
