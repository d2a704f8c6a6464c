#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "rbf/evaluate_internal.h"

namespace krok::rbf::detail {

namespace {

double exp_of(double x) {
  if (!(x >= kMinExponent)) return 0;
  const double rounding = std::fma(x, kLog2E, kRounder);
  const double n = rounding - kRounder;
  const double r = std::fma(n, -kLn2Low, std::fma(n, -kLn2High, x));
  double p = kInverseFactorials[0];
  for (int i = 1; i < kExpTerms; ++i) p = std::fma(p, r, kInverseFactorials[i]);
  const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(rounding) + 1023) << 52;
  return p * std::bit_cast<double>(exponent);
}

// Adds the terms of `count` centres from `first` on to the weights; values[k] are their kernels.
void add_chunk(const Job& job, const double* values, std::size_t first, std::size_t count,
               double* weights) {
  for (std::size_t j = 0; j < job.examples; ++j) {
    const std::size_t block = j / kLanes * kLanes;
    const std::size_t width = job.examples - block > 4 ? kLanes : 4;
    const double* column = job.coefficients + block * job.centres + first * width + (j - block);
    double parts[4] = {};
    for (std::size_t k = 0; k < count; ++k) {
      parts[k % 4] = std::fma(values[k], column[k * width], parts[k % 4]);
    }
    weights[j] += (parts[0] + parts[1]) + (parts[2] + parts[3]);
  }
}

void begin_with_planes(const Job& job, const double* point, double* weights, double* slopes) {
  const std::size_t stride = (job.examples + kLanes - 1) / kLanes * kLanes;
  for (std::size_t j = 0; j < job.examples; ++j) {
    weights[j] = job.affine[j];
    for (std::size_t i = 0; i < job.dimensions; ++i) {
      const double slope = job.affine[(i + 1) * stride + j];
      weights[j] = std::fma(point[i], slope, weights[j]);
      if (slopes != nullptr) slopes[i * job.examples + j] = slope;
    }
  }
}

}  // namespace

Basis basis_scalar(Kernel kernel, double square, double inverse_square) {
  switch (kernel) {
    case Kernel::cubic: {
      const double r = std::sqrt(square);
      return {square * r, 3 * r};
    }
    case Kernel::linear: {
      const double r = std::sqrt(square);
      return {r, r > 0 ? 1 / r : 0};
    }
    case Kernel::gaussian: {
      const double value = exp_of(-kGaussian * (square * inverse_square));
      return {value, -2 * kGaussian * inverse_square * value};
    }
    case Kernel::bspline: {
      const double t = std::sqrt(square * inverse_square);
      const double u = t < 1 ? 1 - t : 0;
      if (t <= 0.5) {
        return {std::fma(6 * (t * t), t - 1, 1.0), std::fma(18.0, t, -12.0) * inverse_square};
      }
      return {2 * (u * u) * u, -6 * (u * u) / t * inverse_square};
    }
    case Kernel::wendland: {
      const double t = std::sqrt(square * inverse_square);
      const double u = t < 1 ? 1 - t : 0;
      const double cube = u * u * u;
      return {cube * u * std::fma(4.0, t, 1.0), -20 * cube * inverse_square};
    }
  }
  return {0, 0};
}

void evaluate_scalar(const Job& job, const double* point, double* weights, double* slopes) {
  begin_with_planes(job, point, weights, slopes);
  double values[kChunk], by_distance[kChunk], directed[kChunk];
  for (std::size_t first = 0; first < job.centres; first += kChunk) {
    const std::size_t count = std::min(kChunk, job.centres - first);
    for (std::size_t k = 0; k < count; ++k) {
      double square = 0;
      for (std::size_t i = 0; i < job.dimensions; ++i) {
        const double along = point[i] - job.places[i * job.centres + first + k];
        square = std::fma(along, along, square);
      }
      const Basis basis = basis_scalar(job.kernel, square, job.inverse_squares[first + k]);
      values[k] = basis.value;
      by_distance[k] = basis.slope;
    }
    add_chunk(job, values, first, count, weights);
    if (slopes == nullptr) continue;
    for (std::size_t i = 0; i < job.dimensions; ++i) {
      const double* places = job.places + i * job.centres + first;
      for (std::size_t k = 0; k < count; ++k) {
        directed[k] = by_distance[k] * (point[i] - places[k]);
      }
      add_chunk(job, directed, first, count, slopes + i * job.examples);
    }
  }
}

}  // namespace krok::rbf::detail
