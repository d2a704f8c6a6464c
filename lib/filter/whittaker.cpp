#include "filter/whittaker.h"

#include <cmath>

#include "core/index.h"
#include "math/types.h"

namespace krok::filter {

Whittaker::Whittaker(int size, double lambda, std::span<const double> weights)
    : weights_(weights.begin(), weights.end()),
      inverse_(at(size)),
      lower1_(at(size)),
      lower2_(at(size)),
      lambda_(lambda) {
  // Diagonals of D^T D, where D takes second differences.
  const auto second = [&](int first, int row) {
    if (first < 0 || first + 2 >= size) return 0.0;
    return row == first + 1 ? -2.0 : 1.0;
  };
  const auto product = [&](int i, int j) {
    double sum = 0;
    for (int first = j - 2; first <= i; ++first) sum += second(first, i) * second(first, j);
    return sum;
  };
  std::vector<double> diagonal(at(size));
  for (int i = 0; i < size; ++i) {
    double d = (weights_.empty() ? 1.0 : weights_[at(i)]) + lambda * product(i, i);
    double below1 = i + 1 < size ? lambda * product(i, i + 1) : 0;
    const double below2 = i + 2 < size ? lambda * product(i, i + 2) : 0;
    if (i > 0) {
      d -= lower1_[at(i - 1)] * lower1_[at(i - 1)] * diagonal[at(i - 1)];
      below1 -= lower1_[at(i - 1)] * lower2_[at(i - 1)] * diagonal[at(i - 1)];
    }
    if (i > 1) d -= lower2_[at(i - 2)] * lower2_[at(i - 2)] * diagonal[at(i - 2)];
    diagonal[at(i)] = d;
    inverse_[at(i)] = 1 / d;
    lower1_[at(i)] = below1 / d;
    lower2_[at(i)] = below2 / d;
    const double sine = std::sin(0.5 * kPi * i / size);
    freedom_ += 1 / (1 + lambda * std::pow(4 * sine * sine, 2));
  }
}

void Whittaker::smooth(std::span<double> values, std::size_t series) const {
  const std::size_t size = inverse_.size();
  if (size < 3) return;
  const auto scale = [&](std::size_t i, double by) {
    for (std::size_t s = 0; s < series; ++s) values[i * series + s] *= by;
  };
  const auto subtract = [&](std::size_t i, std::size_t other, double times) {
    double* const to = &values[i * series];
    const double* const from = &values[other * series];
    for (std::size_t s = 0; s < series; ++s) to[s] -= times * from[s];
  };
  for (std::size_t i = 0; i < size; ++i) {
    if (!weights_.empty()) scale(i, weights_[i]);
    if (i > 0) subtract(i, i - 1, lower1_[i - 1]);
    if (i > 1) subtract(i, i - 2, lower2_[i - 2]);
  }
  for (std::size_t i = size; i-- > 0;) {
    scale(i, inverse_[i]);
    if (i + 1 < size) subtract(i, i + 1, lower1_[i]);
    if (i + 2 < size) subtract(i, i + 2, lower2_[i]);
  }
}

double whittaker_lambda(double cutoff, double rate) {
  const double sine = std::sin(kPi * cutoff / rate);
  return 1 / std::pow(4 * sine * sine, 2);
}

}  // namespace krok::filter
