#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "fit/refine.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"

namespace krok::fit::detail {

// Adds `count` rows of n numbers, each times a factor, to `to`; `stride`: distance between factors.
// SIMD, bit-identical on all instruction sets.
void add_products(const double* factors, std::size_t stride, const double* rows, std::size_t count,
                  std::size_t n, double* to);

// Linear model of how blends at points depend on changes of the rows of inserted points.
struct JointRows {
  std::size_t points = 0, dimensions = 0, rows = 0, examples = 0;
  std::vector<double> influences;  // [points x rows], effect of a change of a row
  std::vector<double> weights;     // [points x examples], with unchanged rows
  std::vector<double> errors;      // [points x d], scaled
  std::vector<double> slopes;      // [points x d x examples], of the errors by the weights
};

struct JointTerms {
  double stay = 0;      // lambda
  double positive = 0;  // mu
  double low = 0;       // weights below it are penalised
  int iterations = 0;   // max
};

// The changes of the rows, [rows x examples], each with sum 0, that minimise the cost in polish.h,
// by Ceres. Independent of the number of jobs. All 0 if nothing improves.
std::vector<double> joint_changes(const JointRows& problem, const JointTerms& terms, int jobs);

struct BlendWeights {
  std::vector<double> weights;
  double error = 0;  // |f(w) - wanted|, scaled; infinity if there are no such weights
};

// Finds weights near `start` (sum 1) whose blend has the parameters `wanted`: minimises the cost in
// refine.h with Ceres, on this thread. `inverse_ranges`: [d].
BlendWeights solve_weights(const rbf::Measure& measure, std::span<const double> inverse_ranges,
                           std::span<const double> wanted, std::span<const double> start,
                           const RefineOptions& options);

// Restores the rows as they were found. Affine part and coefficients are still those of the
// polished rows; a solver recomputes them.
Refined without_polish(Refined refined);

// A point to insert.
struct Found {
  std::vector<double> place, point;  // scaled; in parameter units
  double sought = 0;                 // the error there
  bool low = false;                  // a weight is too low there
  std::vector<double> row;
  bool by_point = false;
  std::optional<Refusal> refusal;
  double value = 0;  // of the refusal
};

// Weights below this are too low: slightly above RefineOptions::lowest.
double low_limit(const RefineOptions& options);

// Finds the row of a point as described in refine.h, or the reason for refusal. `usual`: usual
// distance.
void find_row(const rbf::WeightSolver& solver, const rbf::WeightEvaluator& evaluator,
              const rbf::Measure& measure, const RefineOptions& options, double usual,
              Found& found);

}  // namespace krok::fit::detail
