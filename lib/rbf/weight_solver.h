#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/result.h"
#include "rbf/weight_function.h"

// Makes weight functions from the parameters of examples, and inserts further points with weights
// that are wanted there.

namespace krok::rbf {

namespace detail {
struct WeightSystem;
}

struct SolverOptions {
  Kernel kernel = Kernel::cubic;
  // [d], the parameters' ranges, in their own units; both empty: what the examples span.
  std::vector<double> lower, upper;
  double smoothing = 0;  // see weight_function.h
};

// Planes and coefficients solve a linear system. For cubic and linear, the planes belong to it, and
// the coefficients are orthogonal to planes; with the others the planes are the least-squares fit
// to the examples' weights, and only what they leave over is made of kernels. A new centre adds a
// row and a column to the triangular factors, which costs the square of the number of centres
// instead of its cube. The factors are the same to the bit as those of all centres at once in that
// order: nothing drifts, and a function taken from a file goes on as if it had never been away.
class WeightSolver {
 public:
  // `parameters`: [examples x d], own units. Codes: rbf-dimensions, rbf-examples, rbf-number,
  // rbf-bounds; rbf-duplicate where two examples are closer than a millionth of the ranges;
  // rbf-rank where they lie in a plane of fewer dimensions; rbf-conditioning where the system
  // cannot be solved to kResidual.
  static Result<WeightSolver> create(int dimensions, std::span<const double> parameters,
                                     const SolverOptions& options = {});

  // Goes on from a function made before. Codes: those of create() and WeightFunction::check().
  static Result<WeightSolver> resume(const WeightFunction& function);

  // Inserts points, [points x d], with wanted weights, [points x examples], each row of sum 1 (it
  // is brought to that exactly). On an error nothing has changed. Codes: rbf-number, rbf-duplicate,
  // rbf-centres, rbf-conditioning; rbf-sum for a row whose sum is off by over 1e-6.
  Status insert(std::span<const double> points, std::span<const double> rows);

  // Takes back the points that were inserted last.
  void remove_last(int points);

  const WeightFunction& function() const;

  // An estimate of the condition number of the system, in the 1-norm (Higham 1988); 1 without
  // coefficients.
  double condition() const;

  // How far the weights at the centres are at most from the wanted ones, smoothing allowed for.
  double residual() const;

  // From a point to the nearest centre, in scaled parameters.
  double distance_to_centres(std::span<const double> point) const;

  // How much the row of each inserted point counts at a point: the weights are linear in the rows,
  // w(p) changes by influence_k(p) times what is added to row k. `of_rows`: [inserted]. May be
  // called from several threads.
  void influences(std::span<const double> point, std::span<double> of_rows) const;

  // What residual() may be.
  static constexpr double kResidual = 1e-9;

  WeightSolver(const WeightSolver& other);
  WeightSolver(WeightSolver&& other) noexcept;
  WeightSolver& operator=(const WeightSolver& other);
  WeightSolver& operator=(WeightSolver&& other) noexcept;
  ~WeightSolver();

 private:
  explicit WeightSolver(std::unique_ptr<detail::WeightSystem> system);
  static Result<WeightSolver> from_function(WeightFunction function);
  Status check_insertion(std::span<const double> point, std::span<const double> row) const;
  std::unique_ptr<detail::WeightSystem> system_;
};

}  // namespace krok::rbf
