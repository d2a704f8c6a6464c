#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "rbf/centre_matrix_internal.h"
#include "rbf/weight_function.h"

namespace krok::rbf::detail {

// A weight function under construction: its centres, the target weights at them, and the factors.
struct WeightSystem {
  WeightFunction f;
  CentreMatrix matrix;
  std::vector<std::size_t> others;  // centres that are not in the base
  BorderedFactors factors;          // of kappa over them
  std::vector<double> wanted;       // [centres x N]
  std::vector<double> forward;      // [others x N], L^-1 of the targets minus the affine part
  std::vector<double> plane;  // [(d + 1) x N], for kernels without an affine part in the system
  double residual = 0;

  std::size_t n() const { return static_cast<std::size_t>(f.examples); }
  std::size_t d() const { return static_cast<std::size_t>(f.dimensions); }

  // Starts without centres; `function` has those of its examples. Code: rbf-rank.
  static Result<std::unique_ptr<WeightSystem>> start(WeightFunction function);

  // Adds a centre, to be solved later: first the examples in order (`row` is ignored), then
  // inserted points. After an error, truncate() restores a valid state. Code: rbf-conditioning.
  Status add_centre(std::span<const double> point, std::span<const double> row, double radius);
  void truncate(std::size_t centres);  // at least the examples

  // Computes the function. Code: rbf-conditioning.
  Status solve();

  // See WeightSolver.
  double condition() const;
  void influences(std::span<const double> point, std::span<double> of_rows) const;

 private:
  // The values at centre k, [N], minus the affine part.
  void less_planes(std::span<const double> values, std::size_t k, std::span<double> left) const;
  void add_solution(std::vector<double> solved_below, std::span<const double> values);
  double find_residual(std::span<double> left) const;
};

inline constexpr double kMinDistance = 1e-6;  // between centres, relative to the ranges

// Of the distance to the nearest other centre.
inline double radius_factor(Kernel kernel) {
  return kernel == Kernel::wendland ? 4 : 2;
}

bool all_finite(std::span<const double> values);

// Adds the same number to all elements of a row so that it sums to its target: `first` for the
// first row, `others` for the rest.
void bring_sums(std::span<double> rows, std::size_t columns, double first, double others);

// A point formatted for messages: "(0.3, 12)".
std::string place_text(std::span<const double> point);

}  // namespace krok::rbf::detail
