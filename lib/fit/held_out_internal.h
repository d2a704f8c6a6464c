#pragma once

#include <cstdint>
#include <vector>

#include "fit/refine.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"

namespace krok::fit::detail {

// What a random sequence is for. Only sweep changes with each round.
enum class Use : std::uint64_t { held_out, outside, sweep, polish };
std::uint64_t seed_for(std::uint64_t seed, Use use, std::size_t round = 0);

// Held-out points, which are never fitted, and metrics of weight functions there.
class HeldOut {
 public:
  // For all functions over the range of this one. `measure` and `options` must outlive it.
  HeldOut(const rbf::WeightFunction& function, const rbf::Measure& measure,
          const RefineOptions& options);

  std::size_t count() const { return within_.size() / d_; }

  // Only the errors within, which decide. Stores the first failure in `failure` if it is not null.
  RefineMetrics errors(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator,
                       Error* failure = nullptr) const;
  // Lowest weight at the held-out points.
  double lowest(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator) const;
  // Adds the metrics that are only reported.
  void add_rest(const rbf::WeightSolver& solver, const rbf::WeightEvaluator& evaluator,
                RefineMetrics& metrics) const;

 private:
  const rbf::Measure& measure_;
  const RefineOptions& options_;
  std::size_t d_;
  std::vector<double> within_, outside_;  // scaled
};

}  // namespace krok::fit::detail
