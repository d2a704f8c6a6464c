#include "ik/normal_equations_internal.h"

#include <algorithm>

namespace krok::ik {

void NormalEquations::reset(int rows) {
  rows_ = static_cast<std::size_t>(rows);
  upper_.assign(rows_ * rows_, 0.0);
  factor_.resize(rows_ * rows_);
}

void NormalEquations::add(double w, const double* column, int first, int last) {
  const auto end = static_cast<std::size_t>(last);
  for (auto i = static_cast<std::size_t>(first); i < end; ++i) {
    const double scaled = w * column[i];
    double* __restrict const row = upper_.data() + i * rows_;
    for (std::size_t k = i; k < end; ++k) row[k] += scaled * column[k];
  }
}

void NormalEquations::solve(double damping, const double* e, double* y) {
  // U^T D U by rows, so that the inner loops run along memory; e is carried along.
  const std::size_t n = rows_;
  std::copy(upper_.begin(), upper_.end(), factor_.begin());
  std::copy_n(e, n, y);
  for (std::size_t k = 0; k < n; ++k) {
    double* __restrict const pivot_row = factor_.data() + k * n;
    pivot_row[k] += damping;
    const double inverse = 1 / pivot_row[k];
    for (std::size_t i = k + 1; i < n; ++i) {
      if (pivot_row[i] == 0) continue;
      const double part = pivot_row[i] * inverse;
      double* __restrict const row = factor_.data() + i * n;
      for (std::size_t c = i; c < n; ++c) row[c] -= part * pivot_row[c];
      y[i] -= part * y[k];
    }
    pivot_row[k] = inverse;
  }
  for (std::size_t k = n; k-- > 0;) {
    const double* const row = factor_.data() + k * n;
    double sum = y[k];
    for (std::size_t c = k + 1; c < n; ++c) sum -= row[c] * y[c];
    y[k] = sum * row[k];
  }
}

}  // namespace krok::ik
