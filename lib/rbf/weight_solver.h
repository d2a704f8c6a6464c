#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/result.h"
#include "rbf/weight_function.h"

// Computes weight functions from the parameters of examples, and inserts further points with target
// weights.

namespace krok::rbf {

namespace detail {
struct WeightSystem;
}

struct SolverOptions {
  Kernel kernel = Kernel::cubic;
  // [d], the parameters' ranges, in their units; both empty: the range of the examples.
  std::vector<double> lower, upper;
  double smoothing = 0;  // see weight_function.h
};

// Affine part and coefficients solve a linear system. For cubic and linear, the affine part belongs
// to the system and the coefficients are orthogonal to affine functions. For the other kernels the
// affine part is the least-squares fit to the examples' weights, and the kernels fit the remainder.
// A new centre adds a row and a column to the triangular factors, which costs O(n^2) instead of
// O(n^3). The factors are bit-identical to those computed from all centres at once in that order:
// errors do not accumulate, and a function read from a file continues exactly where it was.
class WeightSolver {
 public:
  // `parameters`: [examples x d], in parameter units. Codes: rbf-dimensions, rbf-examples,
  // rbf-number, rbf-bounds; rbf-duplicate if two examples are closer than a millionth of the
  // ranges; rbf-rank if they lie in a subspace of fewer dimensions; rbf-conditioning if the
  // residual exceeds kResidual.
  static Result<WeightSolver> create(int dimensions, std::span<const double> parameters,
                                     const SolverOptions& options = {});

  // Continues from an existing function. Codes: those of create() and WeightFunction::check().
  static Result<WeightSolver> resume(const WeightFunction& function);

  // Inserts points, [points x d], with target weights, [points x examples]. Each row must sum to 1
  // and is corrected to sum to it exactly. Nothing changes on error. Codes: rbf-number,
  // rbf-duplicate, rbf-centres, rbf-conditioning; rbf-sum if a row's sum is off by more than 1e-6.
  Status insert(std::span<const double> points, std::span<const double> rows);

  // Removes the points inserted last.
  void remove_last(int points);

  const WeightFunction& function() const;

  // Estimated condition number of the system in the 1-norm (Higham 1988); 1 without coefficients.
  double condition() const;

  // Max difference between the weights at the centres and their targets, allowing for smoothing.
  double residual() const;

  // Distance from a point to the nearest centre, in scaled parameters.
  double distance_to_centres(std::span<const double> point) const;

  // Influence of the row of each inserted point at a point: the weights are linear in the rows, so
  // w(p) changes by influence_k(p) times what is added to row k. `of_rows`: [inserted].
  // Thread-safe.
  void influences(std::span<const double> point, std::span<double> of_rows) const;

  // Max accepted residual().
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

// The weights at a few points, [points x examples], of the function that WeightSolver::create()
// makes with the examples' range, equal to within the solver's residual. It needs one solution for
// each point instead of one for each example: with n examples and m points n^3 / 3 + m n^2
// operations, not 2 n^3 and more. `parameters`: [examples x d], `points`: [points x d], both in
// parameter units, finite. Codes: rbf-examples, rbf-duplicate, rbf-conditioning.
Result<std::vector<double>> point_weights(int dimensions, std::span<const double> parameters,
                                          Kernel kernel, double smoothing,
                                          std::span<const double> points);

}  // namespace krok::rbf
