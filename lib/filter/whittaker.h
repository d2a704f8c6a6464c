#pragma once

#include <cstddef>
#include <span>
#include <vector>

// Whittaker smoothing: penalised least squares of evenly sampled values.

namespace krok::filter {

// Minimises sum w[i] (y[i] - x[i])^2 + lambda sum (second difference of y)^2. Linear, zero-phase; a
// straight line is unchanged. A value of weight 0 is interpolated by a cubic spline. After
// Whittaker (Proceedings of the Edinburgh Mathematical Society 41, 1923) and Eilers (Analytical
// Chemistry 75, 2003).
class Whittaker {
 public:
  // `lambda` > 0, finite. `weights`: one for each value, >= 0, at least two above 0; empty: all 1.
  Whittaker(int size, double lambda, std::span<const double> weights = {});

  // In place, of `size` values each of so many series, of which the first values come first. Fewer
  // than three values are unchanged.
  void smooth(std::span<double> values, std::size_t series = 1) const;

  // Degrees of freedom: the trace of the matrix that smooths, for weights of 1. From its
  // eigenvalues in the cosine basis, within 1 of the exact trace.
  double freedom() const { return freedom_; }
  double lambda() const { return lambda_; }

 private:
  std::vector<double> weights_;
  // L D L^T of the pentadiagonal matrix: 1 / D, and L's two lower diagonals.
  std::vector<double> inverse_, lower1_, lower2_;
  double lambda_, freedom_ = 0;
};

// The lambda for which the gain is 1/2 at `cutoff` Hz, 0 < cutoff <= rate / 2.
double whittaker_lambda(double cutoff, double rate);

}  // namespace krok::filter
