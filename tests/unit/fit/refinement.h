#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "fit/refine.h"
#include "rbf/weight_solver.h"
#include "support/arm.h"

// Refinements to begin with, and what tests ask of them.

namespace krok::fit::test {

using Values = std::vector<double>;
using krok::test::Arm;
using krok::test::make_arm;

inline Refined start_of(int dimensions, const Values& parameters,
                        rbf::Kernel kernel = rbf::Kernel::cubic) {
  const auto solver = rbf::WeightSolver::create(dimensions, parameters, {kernel, {}, {}});
  EXPECT_TRUE(solver.ok()) << solver.error().message;
  Refined start;
  start.function = solver->function();
  return start;
}
inline Refined start_of(const Arm& arm, rbf::Kernel kernel = rbf::Kernel::cubic) {
  return start_of(arm.dimensions, arm.parameters, kernel);
}

inline Refined refined(const Refined& start, const rbf::Measure& measure,
                       const RefineOptions& options) {
  Progress quiet;
  auto result = refine(start, measure, options, quiet);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? std::move(*result) : Refined{};
}

inline RefineOptions with_points(int points) {
  RefineOptions options;
  options.points = points;
  return options;
}

// The largest error of any parameter after the last round that had at most so many points.
inline double error_at(const Refined& refined, int points) {
  double error = std::numeric_limits<double>::infinity();
  int inserted = 0;
  for (const RefineRound& round : refined.rounds) {
    inserted += round.inserted;
    if (inserted > points) break;
    error = 0;
    for (const ParameterError& e : round.after.within) error = std::max(error, e.largest);
  }
  return error;
}

inline void expect_good_weights(const Refined& refined) {
  const RefineMetrics& last = refined.rounds.back().after;
  EXPECT_GE(last.least_weight, -0.15);
  EXPECT_LE(last.roughness, 1.1 * refined.before.roughness);
  EXPECT_LT(refined.example_error, 1e-9);
}

}  // namespace krok::fit::test
