#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "rbf/bordered_factors_internal.h"
#include "rbf/centre_matrix_internal.h"
#include "rbf/weight_function.h"

namespace krok::rbf::detail {

// A weight function in the making: its centres, what is wanted at them, and the factors.
struct WeightSystem {
  WeightFunction f;
  CentreMatrix matrix;
  std::vector<std::size_t> others;  // the centres that are not of the base
  BorderedFactors factors;          // of kappa over them
  std::vector<double> wanted;       // [centres x N]
  std::vector<double> forward;      // [others x N], L^-1 of what is wanted less the planes
  std::vector<double> plane;        // [(d + 1) x N], of kernels without planes in the system
  double residual = 0;

  std::size_t n() const { return static_cast<std::size_t>(f.examples); }
  std::size_t d() const { return static_cast<std::size_t>(f.dimensions); }

  // Without centres yet; `function` has those of its examples. Code: rbf-rank.
  static Result<std::unique_ptr<WeightSystem>> start(WeightFunction function);

  // Adds a centre, whose part in the function is solved later: the examples in their order, whose
  // rows are not read, then other points.
  // After an error truncate() mends. Code: rbf-conditioning.
  Status add_centre(std::span<const double> point, std::span<const double> row, double radius);
  void truncate(std::size_t centres);  // the examples at least

  // Makes the function. Code: rbf-conditioning.
  Status solve();

  // See WeightSolver.
  double condition() const;
  void influences(std::span<const double> point, std::span<double> of_rows) const;

 private:
  // What is left of values at centre k, [N], when the planes are taken off.
  void less_planes(std::span<const double> values, std::size_t k, std::span<double> left) const;
  void add_solution(std::vector<double> solved_below, std::span<const double> values);
  double find_residual(std::span<double> left) const;
};

bool all_finite(std::span<const double> values);

// Adds to each row the same number, so that it sums to what it should: `first` for the first row.
void bring_sums(std::span<double> rows, std::size_t columns, double first, double others);

// A point for people: "(0.3, 12)".
std::string place_text(std::span<const double> point);

}  // namespace krok::rbf::detail
