#pragma once

#include <cstdint>
#include <vector>

#include "fit/refine.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"

namespace krok::fit::detail {

// Which points a random sequence is for. Only a sweep's are others in each round.
enum class Use : std::uint64_t { held_out, outside, sweep, polish };
std::uint64_t seed_for(std::uint64_t seed, Use use, std::size_t round = 0);

// The points at which nothing is fitted, and how good weight functions are there.
class HeldOut {
 public:
  // For all functions over the range of this one. The measure and the options outlive it.
  HeldOut(const rbf::WeightFunction& function, const rbf::Measure& measure,
          const RefineOptions& options);

  std::size_t count() const { return within_.size() / d_; }

  // Of the figures the errors within, which decide. The first failure in `failure`, if it is not
  // null.
  RefineMetrics errors(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator,
                       Error* failure = nullptr) const;
  // Of all weights.
  double lowest(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator) const;
  // The figures that are only told.
  void add_rest(const rbf::WeightSolver& solver, const rbf::WeightEvaluator& evaluator,
                RefineMetrics& metrics) const;

 private:
  const rbf::Measure& measure_;
  const RefineOptions& options_;
  std::size_t d_;
  std::vector<double> within_, outside_;  // places
};

}  // namespace krok::fit::detail
