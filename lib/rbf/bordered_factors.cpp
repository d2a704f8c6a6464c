#include <cmath>

#include "rbf/bordered_factors_internal.h"

namespace krok::rbf::detail {

namespace {

// Four partial sums, so that additions do not wait for each other.
double dot(const double* a, const double* b, std::size_t count) {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    for (std::size_t lane = 0; lane < 4; ++lane) sums[lane] += a[i + lane] * b[i + lane];
  }
  for (std::size_t lane = 0; i < count; ++i, ++lane) sums[lane] += a[i] * b[i];
  return (sums[0] + sums[2]) + (sums[1] + sums[3]);
}

}  // namespace

bool BorderedFactors::append(std::span<const double> row, std::span<const double> column,
                             double corner, double least) {
  const std::size_t begin = size_ * (size_ + 1) / 2;
  lower_.resize(begin + size_ + 1);
  upper_.resize(begin + size_ + 1);
  double* l = lower_.data() + begin;
  double* u = upper_.data() + begin;
  for (std::size_t k = 0; k < size_; ++k) {
    const double* above = lower_.data() + k * (k + 1) / 2;
    const double* before = upper_.data() + k * (k + 1) / 2;
    u[k] = column[k] - dot(above, u, k);
    l[k] = (row[k] - dot(before, l, k)) / before[k];
    corner -= l[k] * u[k];
  }
  if (!(std::abs(corner) >= least) || !std::isfinite(corner)) return false;
  l[size_] = 1;
  u[size_] = corner;
  ++size_;
  return true;
}

void BorderedFactors::solve_lower(std::span<double> values, std::size_t columns,
                                  std::size_t first) const {
  for (std::size_t k = first; k < size_; ++k) {
    double* to = values.data() + k * columns;
    for (std::size_t i = 0; i < k; ++i) {
      const double factor = lower(k, i);
      const double* from = values.data() + i * columns;
      for (std::size_t j = 0; j < columns; ++j) to[j] -= factor * from[j];
    }
  }
}

void BorderedFactors::solve_upper(std::span<double> values, std::size_t columns) const {
  for (std::size_t k = size_; k-- > 0;) {
    double* from = values.data() + k * columns;
    const double pivot = upper(k, k);
    for (std::size_t j = 0; j < columns; ++j) from[j] /= pivot;
    for (std::size_t i = 0; i < k; ++i) {
      const double factor = upper(i, k);
      double* to = values.data() + i * columns;
      for (std::size_t j = 0; j < columns; ++j) to[j] -= factor * from[j];
    }
  }
}

void BorderedFactors::solve_transposed(std::span<double> values) const {
  for (std::size_t k = 0; k < size_; ++k) {
    for (std::size_t i = 0; i < k; ++i) values[k] -= upper(i, k) * values[i];
    values[k] /= upper(k, k);
  }
  for (std::size_t k = size_; k-- > 0;) {
    for (std::size_t i = 0; i < k; ++i) values[i] -= lower(k, i) * values[k];
  }
}

}  // namespace krok::rbf::detail
