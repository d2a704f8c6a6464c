#pragma once

#include <cstddef>

#include "fit/refine.h"

// Polishing: refinement finds the row of each inserted point by itself, right at that point; what
// the functions make of the rows in between is not. The weights are linear in the rows,
// w(p) = .. + sum_k c_k(p) row_k, so that all rows can be moved together, to the least of
//
//   mean_p |f(w(p)) - p|^2 + lambda^2 mean_k |row_k - found_k|^2
//                          + mu^2 mean_p sum_i max(0, low - w_i(p))^2
//
// over many points p (each parameter scaled by its range), with f taken as linear about the rows as
// found; sums stay 1, and c_k is 0 at the examples. Errors at points that nothing was fitted to
// come down to about half in the mean (samples/step_library/README.md has figures).

namespace krok::fit {

// Over so many inserted points, or weights of them all, nothing is polished: it takes time with the
// square of the points, and what was found is kept besides.
inline constexpr int kMaxPolished = 1024;
inline constexpr std::size_t kMaxPolishedWeights = 1 << 19;

// Moves the rows of a refinement's inserted points, the whole way or a half or a quarter of it:
// the first that, at the points held out, makes the mean square of the error smaller, the largest
// error and what cannot be measured no larger, misses no tolerance that was met, and keeps weights
// within `least`, `largest` and `lowest` and their roughness within 1.1 of the unrefined one, or
// makes them no worse where they are beyond. Where none does, the result is `start`, not polished.
// What is polished already is polished anew. The options are those of the refinement. Codes: those
// of rbf::WeightSolver::resume().
Result<Refined> polish(const Refined& start, const rbf::Measure& measure,
                       const RefineOptions& options);

}  // namespace krok::fit
