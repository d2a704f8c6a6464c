#pragma once

#include <span>
#include <vector>

#include "core/result.h"

namespace krok::filter {

// Smoothing by a least-squares polynomial of degree `degree` over each window of `window` values,
// evaluated at its middle (Savitzky and Golay, Analytical Chemistry 36, 1964). Preserves peaks
// better than a low-pass of the same strength. The first and last window / 2 values are evaluated
// from the first and last window's polynomial (as scipy.signal.savgol_filter with mode "interp").
struct SavitzkyGolay {
  int window = 9;  // frames, odd
  int degree = 3;  // 0 <= degree < window, at most 12
};

// Codes: filter-window (even, not positive, or over 2001), filter-degree.
Status check(const SavitzkyGolay& filter);

// The weights of a filter, reusable for many series. The filter must pass check().
class PolynomialSmoother {
 public:
  explicit PolynomialSmoother(const SavitzkyGolay& filter);

  // In place. A series shorter than the window is unchanged.
  void smooth(std::span<double> series) const;

 private:
  int window_;
  std::vector<double> weights_;  // [window x window]; row r gives the fitted value at index r
};

}  // namespace krok::filter
