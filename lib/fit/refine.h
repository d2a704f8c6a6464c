#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "rbf/inverse.h"
#include "rbf/weight_function.h"

// Adaptive refinement: the blend with weights w(p) has parameters f(w(p)) that differ slightly from
// p, since rotations do not add linearly. Where the error is largest, weights are found whose blend
// has the requested parameters, and are inserted into the weight functions as new points.
//
// Each round samples the parameters' range with a Sobol sequence, climbs from the worst samples to
// local maxima p* of |f(w(p)) - p| (each parameter scaled by its range), and takes the worst few
// that are spaced apart. For each it searches p' with f(w(p')) = p*, so that w(p') is the new row;
// if there is none, the row is w(p*) + Z y, with Z an orthonormal basis of the vectors with sum 0,
// that minimises
//
//   |(f(w) - p*) / S|^2 + lambda^2 |y|^2 + mu^2 sum_i max(0, -w_i - epsilon)^2.
//
// Rows that pass the guards are inserted. They are removed again if, at held-out points, the mean
// square error grows to more than 1.25 times its minimum so far, or the lowest weight falls below
// `lowest` (or, if it was below at first, by more than 0.02 below that).
//
// After a few rounds in vain, points keep an increasing distance from those refused, so that the
// search goes on elsewhere.
//
// If weights are below `lowest` at first (cubic reaches -0.17 between five examples in a row, -0.3
// between captured ones), up to half of a round's points are placed there, with the second kind of
// row.

namespace krok::fit {

struct RefineOptions {
  // Region where points are sampled, held out and inserted; must be thread-safe. Examples are used
  // wherever they are.
  rbf::Inside inside;
  int points = 0;  // max total of inserted points; 0: 40 per parameter
  std::vector<double>
      tolerance;    // [d], parameter units, for the largest held-out error; empty: none
  double gain = 0;  // with a tolerance: also continue until that error has shrunk by this factor
  int rounds = 0;   // max in this call; 0: no limit
  std::uint64_t seed = 1;  // for sampled and held-out points
  int jobs = 0;            // threads, see thread_count(); does not affect the result

  int points_a_round = 4;
  int sweep = 0;     // sampled points per round; 0: 128 per parameter
  int held_out = 0;  // 0: 256 per parameter, at most 1024

  double scale = 1e-3;   // S, of the ranges
  double stay = 0.1;     // lambda
  double positive = 10;  // mu
  double slack = 0.05;   // epsilon
  double least = -0.25;  // min and max weight of a new row
  double largest = 1.25;
  double lowest = -0.15;  // min weight anywhere inside
};

// |f(w(p)) - p| of one parameter, in its unit, over a set of points.
struct ParameterError {
  double largest = 0, mean = 0;
  double most = 0;  // 95th percentile

  bool operator==(const ParameterError&) const = default;
};

// Quality metrics of weight functions.
struct RefineMetrics {
  std::vector<ParameterError> within;   // [d], at held-out points
  std::vector<ParameterError> outside;  // [d], not inside, up to a quarter of the range beyond it
  double largest = 0;                   // scaled by the ranges, within
  double mean_square = 0;               // scaled by the ranges, within
  int failed = 0;                       // number of held-out points where f could not be measured
  double least_weight = 0, largest_weight = 0, roughness = 0;  // see rbf/weight_function.h
  double condition = 1;                                        // see rbf/weight_solver.h

  bool operator==(const RefineMetrics&) const = default;
};

enum class Refusal : unsigned char {
  weights,   // outside [least, largest], or below `lowest` held out; value: worst weight
  residual,  // f(w) does not reach p*; value: remaining error, scaled
  near,      // a centre is closer than a quarter of the usual distance; value: distance, scaled
  system,    // the linear system becomes ill-conditioned; value: 0
  growth     // the error at held-out points grows; value: the new largest error, scaled
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
  int by_point = 0;   // inserted points whose row is w(p')
  double sought = 0;  // largest scaled error found before inserting
  RefineMetrics after;

  bool operator==(const RefineRound&) const = default;
};

enum class Stop : unsigned char {
  none,       // not started
  rounds,     // RefineOptions::rounds were made
  points,     // RefineOptions::points were inserted
  tolerance,  // reached
  exact,      // all errors are below a billionth of the ranges
  stalled     // no point was accepted in ten consecutive rounds
};
// "rounds", "points", ...
std::string_view stop_name(Stop stop);

// Result of polishing, see polish.h.
struct Polished {
  std::vector<double> found_rows;  // [inserted x N], before polishing
  RefineMetrics after;

  bool operator==(const Polished&) const = default;
};

// Weight functions and their history: everything needed to continue.
struct Refined {
  rbf::WeightFunction function;
  double example_error = 0;  // largest scaled error at the examples; should be 0
  RefineMetrics before;
  std::vector<RefineRound> rounds;
  std::vector<RefusedPoint> refused;
  Stop stop = Stop::none;
  std::optional<Polished> polished;

  bool operator==(const Refined&) const = default;
};

// Refines `start`: a bare function at first (its examples, possibly with inserted points), later a
// result of this function. Continuing after a stop at `rounds` is bit-identical to a call that did
// not stop, even if the result was polished in between. Progress counts inserted points. Codes:
// those of rbf::WeightSolver::resume(); fit-options for options out of range; fit-inside if
// `inside` is never true; fit-measure if f fails at an example or at more than half of the held-out
// points, with the measure's message.
Result<Refined> refine(const Refined& start, const rbf::Measure& measure,
                       const RefineOptions& options, Progress& progress);

}  // namespace krok::fit
