#pragma once

#include <cstddef>

#include "rbf/weight_function.h"

// Shared by the scalar reference and the SIMD kernels: plain pointers and numbers. No inline
// functions here, see pose/pose_kernels_internal.h.
//
// Kernels and reference use the same operations, fused alike and in the same order, so that results
// are bit-identical: each weight is summed over the centres in four partial sums (centre k in sum k
// % 4), one chunk of centres at a time.

namespace krok::rbf::detail {

inline constexpr std::size_t kLanes = 8;    // block size of centres and weights
inline constexpr std::size_t kChunk = 256;  // centres per chunk

struct Job {
  Kernel kernel;
  std::size_t dimensions;
  std::size_t examples;
  std::size_t centres;            // a multiple of kLanes; padding has coefficients of 0
  const double* places;           // [d x centres], scaled
  const double* inverse_squares;  // [centres], 1 / radius^2
  // Blocks of weights, [centres x 8]; the last is [centres x 4] if it has at most four.
  const double* coefficients;
  const double* affine;  // [(d + 1) x examples in blocks of 8]
};

// `point` is scaled. weights: [examples]; slopes: [d x examples] by scaled parameters, or null.
void evaluate_scalar(const Job& job, const double* point, double* weights, double* slopes);
// Uses the best instruction set of this machine.
void evaluate_best(const Job& job, const double* point, double* weights, double* slopes);

// phi by the squared distance, and the slope d phi / d r divided by r.
struct Basis {
  double value, slope;
};
Basis basis_scalar(Kernel kernel, double square, double inverse_square);

// exp(x) for x <= 0: x = n ln 2 + r, with a Taylor polynomial in r.
inline constexpr double kMinExponent = -700;  // 0 below it
inline constexpr double kLog2E = 0x1.71547652b82fep+0;
inline constexpr double kRounder = 0x1.8p+52;  // moves n into the low bits
inline constexpr double kLn2High = 0x1.62e42fefa0000p-1;
inline constexpr double kLn2Low = 0x1.cf79abc9e3b3ap-40;
inline constexpr int kExpTerms = 14;
inline constexpr double kInverseFactorials[kExpTerms] = {1.0 / 6227020800.0,
                                                         1.0 / 479001600.0,
                                                         1.0 / 39916800.0,
                                                         1.0 / 3628800.0,
                                                         1.0 / 362880.0,
                                                         1.0 / 40320.0,
                                                         1.0 / 5040.0,
                                                         1.0 / 720.0,
                                                         1.0 / 120.0,
                                                         1.0 / 24.0,
                                                         1.0 / 6.0,
                                                         0.5,
                                                         1.0,
                                                         1.0};
inline constexpr double kGaussian = 4;  // exp(-kGaussian t^2)

}  // namespace krok::rbf::detail
