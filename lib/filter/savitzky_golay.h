#pragma once

#include <span>
#include <vector>

#include "core/result.h"

namespace krok::filter {

// Smoothing by a polynomial of degree `degree` fitted to each window of `window` values by least
// squares and read at its middle (Savitzky and Golay, Analytical Chemistry 36, 1964). Keeps peaks
// better than a low-pass of the same strength. The first and last window / 2 values are read from
// the first and last window's polynomial (as scipy.signal.savgol_filter with mode "interp").
struct SavitzkyGolay {
  int window = 9;  // frames, odd
  int degree = 3;  // 0 <= degree < window
};

// Codes: filter-window (not odd, not positive, over 2001), filter-degree.
Status check(const SavitzkyGolay& filter);

// The weights of one filter, made once for many series. check() must hold.
class PolynomialSmoother {
 public:
  explicit PolynomialSmoother(const SavitzkyGolay& filter);

  // In place. A series shorter than the window is left as it is.
  void smooth(std::span<double> series) const;

 private:
  int window_;
  std::vector<double> weights_;  // [window x window]; row r gives the fitted value at place r
};

}  // namespace krok::filter
