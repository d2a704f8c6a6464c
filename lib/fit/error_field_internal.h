#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fit/refine.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"

namespace krok::fit::detail {

// The error |f(w(p)) - p| over the points p of the parameters' range. "Places" are scaled
// parameters, [0, 1] within the range.
class ErrorField {
 public:
  ErrorField(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator,
             const rbf::Measure& measure, const rbf::Inside& inside, int jobs)
      : function_(function),
        evaluator_(evaluator),
        measure_(measure),
        inside_(inside),
        jobs_(jobs) {}

  // Error components at `places`, both [places x d], scaled; NaN where f fails. Stores the first
  // failure in `failure` if it is not null.
  std::vector<double> at(std::span<const double> places, Error* failure = nullptr) const;

  // Climbs from each of the places, [places x d], to a local maximum of the error within the range
  // and inside. `stride`: length of the first step. Updates the places and returns their errors,
  // scaled.
  std::vector<double> climb(std::span<double> places, double stride) const;

  // Norms of errors from at(); 0 where f failed.
  std::vector<double> lengths(std::span<const double> errors) const;

  // Errors from at() per parameter, in its unit.
  std::vector<ParameterError> by_parameter(std::span<const double> errors) const;

  std::size_t dimensions() const { return static_cast<std::size_t>(function_.dimensions); }

 private:
  double climb_from(std::span<double> place, double stride) const;

  const rbf::WeightFunction& function_;
  const rbf::WeightEvaluator& evaluator_;
  const rbf::Measure& measure_;
  const rbf::Inside& inside_;
  int jobs_;
};

// Points of the Sobol sequence, [count x d]: inside and in the range, or not inside and at most a
// quarter of the range beyond it.
std::vector<double> places_within(const rbf::WeightFunction& function, int count,
                                  std::uint64_t seed, const rbf::Inside& inside);
std::vector<double> places_around(const rbf::WeightFunction& function, int count,
                                  std::uint64_t seed, const rbf::Inside& inside);

// Converts a scaled place to parameter units.
void unscale(const rbf::WeightFunction& function, std::span<const double> place,
             std::span<double> point);

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

// Fractions of the usual distance: min distance of a new point to a centre, and between points of a
// round.
inline constexpr double kNear = 0.25;
inline constexpr double kApart = 0.5;
inline constexpr double kNegligible = 1e-9;  // scaled errors below it are ignored

// Median distance from each centre to the nearest other one, in scaled parameters.
double usual_distance(const rbf::WeightFunction& function);

struct ErrorPoint {
  std::vector<double> place;  // scaled
  double error = 0;           // scaled
};

// Whether none of the others is closer than `least`.
bool is_apart(std::span<const double> place, std::span<const ErrorPoint> others, double least);

// Climbs from the worst places of a sweep, [places x d], that are spaced apart; returns the worst
// few, at most `wanted`, worst first, none closer than `avoid` to those avoided. `usual`: usual
// distance; `worst`: receives the largest error of the sweep.
std::vector<ErrorPoint> worst_points(const ErrorField& field, std::span<const double> sweep,
                                     const std::vector<ErrorPoint>& avoided, std::size_t wanted,
                                     double usual, double avoid, double& worst);

// The lowest weight at scaled places, [places x d].
double lowest_weight(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator,
                     std::span<const double> places);

// At most `wanted` places with a weight below `limit`, lowest first, spaced from each other and
// from those avoided. `usual`: usual distance.
std::vector<std::vector<double>> low_places(const rbf::WeightFunction& function,
                                            const rbf::WeightEvaluator& evaluator,
                                            std::span<const double> places,
                                            const std::vector<ErrorPoint>& avoided,
                                            std::size_t wanted, double limit, double usual);

}  // namespace krok::fit::detail
