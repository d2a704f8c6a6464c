#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "rbf/inverse.h"
#include "rbf/weight_function.h"

// Adaptive refinement: the blend with weights w(p) has parameters f(w(p)) that are not quite p,
// since rotations do not add up linearly. Where the error is greatest, weights are found whose
// blend has the parameters asked for, and the weight functions are made to pass through them.
//
// A round looks at a Sobol sequence of points over the parameters' range, climbs from the worst of
// them to where |f(w(p)) - p| (each parameter scaled by its range) has a local maximum p*, and
// takes the worst few that lie apart. For each, a p' is sought with f(w(p')) = p*, so that w(p') is
// the new row; where there is none, the row is w(p*) + Z y, Z an orthonormal basis of what sums to
// 0, with the least
//
//   |(f(w) - p*) / S|^2 + lambda^2 |y|^2 + mu^2 sum_i max(0, -w_i - epsilon)^2.
//
// Rows that pass the guards are inserted, and taken back if the mean square of the error at points
// held out grows by more than a quarter over the least that it has been, or the lowest weight there
// falls under `lowest`, or by a fiftieth under what it was at first if that is lower.
//
// Where a weight is under `lowest` to begin with (a cubic swings to -0.17 between five examples in
// a row, to -0.3 between those of captures) up to half of a round's points go there, with the
// second kind of row.

namespace krok::fit {

struct RefineOptions {
  // Where points are looked at, held out and inserted; called by several threads. Examples count
  // wherever they lie.
  rbf::Inside inside;
  int points = 0;                 // inserted at most in all; 0: 40 for each parameter
  std::vector<double> tolerance;  // [d] own units, of the largest error held out; empty: go on
  double gain = 0;  // with a tolerance: go on until that error is by so much smaller than at first
  int rounds = 0;   // at most in this call; 0: any number
  std::uint64_t seed = 1;  // of the points looked at and held out
  int jobs = 0;            // threads, see thread_count(); the result is the same with any

  int points_a_round = 4;
  int sweep = 0;     // points looked at in each round; 0: 128 for each parameter
  int held_out = 0;  // 0: 256 for each parameter, at most 1024

  double scale = 1e-3;   // S, of the ranges
  double stay = 0.1;     // lambda
  double positive = 10;  // mu
  double slack = 0.05;   // epsilon
  double least = -0.25;  // what weights of a new row may be
  double largest = 1.25;
  double lowest = -0.15;  // no weight is to be lower inside
};

// Of one parameter in its own unit: |f(w(p)) - p| over a set of points.
struct ParameterError {
  double largest = 0, mean = 0;
  double most = 0;  // 95 % of the points have no more

  bool operator==(const ParameterError&) const = default;
};

// How good weight functions are.
struct RefineMetrics {
  std::vector<ParameterError> within;  // [d], at the points held out
  std::vector<ParameterError>
      outside;             // [d], at points up to a quarter of the range beyond it, and not inside
  double largest = 0;      // scaled by the ranges, within
  double mean_square = 0;  // the same
  int failed = 0;          // points at which f could not be measured
  double least_weight = 0, largest_weight = 0, roughness = 0;  // see rbf/weight_figures.h
  double condition = 1;                                        // see rbf/weight_solver.h

  bool operator==(const RefineMetrics&) const = default;
};

enum class Refusal : unsigned char {
  weights,   // leave [least, largest], or fall under `lowest` held out; value: the one furthest off
  residual,  // f(w) stays away from p*; value: by how much, scaled
  near,      // a centre is closer than a quarter of the usual distance; value: how near, scaled
  system,    // the linear system cannot be solved well with it; value: 0
  growth     // the error at points held out grows; value: to what, scaled
};
// "weights", "residual", ...
std::string_view refusal_name(Refusal refusal);

struct RefusedPoint {
  int round = 0;  // counted from 0
  std::vector<double> point;
  Refusal reason = Refusal::weights;
  double value = 0;

  bool operator==(const RefusedPoint&) const = default;
};

struct RefineRound {
  int inserted = 0, refused = 0;
  int by_point = 0;   // of those inserted: found as w(p')
  double sought = 0;  // the largest scaled error that the round found before it inserted
  RefineMetrics after;

  bool operator==(const RefineRound&) const = default;
};

enum class Stop : unsigned char {
  none,       // not begun
  rounds,     // as many as this call was to make
  points,     // all are inserted
  tolerance,  // reached
  exact,      // no error is left that is over a billionth of the ranges
  stalled     // no point was accepted in three rounds one after the other
};
// "rounds", "points", ...
std::string_view stop_name(Stop stop);

// What polishing made of the weights, see polish.h.
struct Polished {
  std::vector<double> found_rows;  // [inserted x N], as they were before
  RefineMetrics after;

  bool operator==(const Polished&) const = default;
};

// Weight functions and how they came to be: all that is needed to go on.
struct Refined {
  rbf::WeightFunction function;
  double example_error = 0;  // the largest scaled error at the examples themselves; should be 0
  RefineMetrics before;
  std::vector<RefineRound> rounds;
  std::vector<RefusedPoint> refused;
  Stop stop = Stop::none;
  std::optional<Polished> polished;

  bool operator==(const Refined&) const = default;
};

// Goes on from `start`, which at first has a function alone (its examples, or with points
// inserted), later a result of this function. Going on after a stop at `rounds` gives the same bits
// as a call that was not stopped, also when it has been polished meanwhile. Progress counts the
// points inserted. Codes: those of rbf::WeightSolver::resume(); fit-options for options out of
// range; fit-inside where `inside` holds nowhere; fit-measure where f fails at an example or at
// more than half of the points held out, with the measure's own words.
Result<Refined> refine(const Refined& start, const rbf::Measure& measure,
                       const RefineOptions& options, Progress& progress);

}  // namespace krok::fit
