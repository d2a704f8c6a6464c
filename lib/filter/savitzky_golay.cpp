#include "filter/savitzky_golay.h"

#include <fmt/format.h>

#include <algorithm>

#include "math/dense_solve.h"

namespace krok::filter {

namespace {

// The weights take window^2 values.
constexpr int kLargestWindow = 2001;

}  // namespace

Status check(const SavitzkyGolay& filter) {
  if (filter.window < 1 || filter.window % 2 == 0 || filter.window > kLargestWindow) {
    return Error("filter-window", fmt::format("invalid window of {} frames", filter.window),
                 fmt::format("use an odd number from 1 to {}", kLargestWindow));
  }
  constexpr int kHighest = 12;
  if (filter.degree < 0 || filter.degree >= filter.window || filter.degree > kHighest) {
    return Error("filter-degree",
                 fmt::format("a polynomial of degree {} cannot be fitted to {} frames",
                             filter.degree, filter.window),
                 fmt::format("the degree must be less than the window and at most {}", kHighest));
  }
  return {};
}

PolynomialSmoother::PolynomialSmoother(const SavitzkyGolay& filter) : window_(filter.window) {
  const int n = window_, columns = filter.degree + 1;
  // Legendre recurrence over [-1, 1]: the columns are nearly orthogonal for any degree.
  Eigen::MatrixXd basis(n, columns);
  for (int row = 0; row < n; ++row) {
    const double x = n == 1 ? 0 : 2.0 * row / (n - 1) - 1;
    basis(row, 0) = 1;
    if (columns > 1) basis(row, 1) = x;
    for (int k = 2; k < columns; ++k) {
      basis(row, k) = ((2 * k - 1) * x * basis(row, k - 1) - (k - 1) * basis(row, k - 2)) / k;
    }
  }
  const Eigen::MatrixXd q = orthonormal_columns(basis);
  weights_.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      weights_.data(), n, n) = q * q.transpose();
}

void PolynomialSmoother::smooth(std::span<double> series) const {
  const auto size = static_cast<int>(series.size());
  if (size < window_) return;
  const int half = window_ / 2;
  const std::vector<double> given(series.begin(), series.end());
  for (int i = 0; i < size; ++i) {
    const int first = std::clamp(i - half, 0, size - window_);
    const double* row = weights_.data() + static_cast<std::ptrdiff_t>(i - first) * window_;
    double sum = 0;
    for (int k = 0; k < window_; ++k) sum += row[k] * given[static_cast<std::size_t>(first + k)];
    series[static_cast<std::size_t>(i)] = sum;
  }
}

}  // namespace krok::filter
