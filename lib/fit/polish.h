#pragma once

#include <cstddef>

#include "fit/refine.h"

// Joint optimisation of all inserted rows. Refinement finds the row of each inserted point
// separately, which is exact at that point but ignores the space in between. The weights are linear
// in the rows, w(p) = .. + sum_k c_k(p) row_k, so polishing moves all rows together to minimise
//
//   mean_p |f(w(p)) - p|^2 + lambda^2 mean_k |row_k - found_k|^2
//                          + mu^2 mean_p sum_i max(0, low - w_i(p))^2
//
// over many points p (each parameter scaled by its range), with f linearised at the rows as found.
// Sums stay 1, and c_k is 0 at the examples. The mean error at held-out points drops to about half
// (measurements: samples/step_library/README.md).

namespace krok::fit {

// Above these limits polish() does nothing, because its time grows with the square of the points.
inline constexpr int kMaxPolished = 1024;
inline constexpr std::size_t kMaxPolishedWeights = 1 << 19;

// Moves the rows of a refinement's inserted points by the full, half or a quarter of the optimal
// change: the first that, at held-out points, reduces the mean square error, increases neither the
// largest error nor the number of failures, keeps met tolerances, keeps weights within `least`,
// `largest` and `lowest` and roughness within 1.1 times that before refinement, or no worse than
// before where they exceed that. If none does, returns `start` without polish. Already polished
// rows are polished again from the rows as found. `options` are those of the refinement. Codes:
// those of rbf::WeightSolver::resume().
Result<Refined> polish(const Refined& start, const rbf::Measure& measure,
                       const RefineOptions& options);

}  // namespace krok::fit
