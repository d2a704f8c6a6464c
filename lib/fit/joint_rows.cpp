#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "core/parallel.h"
#include "fit/joint_rows_internal.h"

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

}  // namespace krok::fit::detail
