#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fit/refine.h"
#include "rbf/weight_evaluator.h"

namespace krok::fit::detail {

// The error |f(w(p)) - p| over the points p of the parameters' range. Places are in scaled
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

  // At [places x d]: the parts of the error, scaled, [places x d]; NaN where f fails. The first
  // failure's Error in `failure`, if it is not null.
  std::vector<double> at(std::span<const double> places, Error* failure = nullptr) const;

  // Climbs from each of the places, [places x d], within the range and inside, to where the error
  // is largest around; `stride`: how far a first step goes. The places, and the error there,
  // scaled.
  std::vector<double> climb(std::span<double> places, double stride) const;

  // Of errors from at(): the length of each; 0 where f failed.
  std::vector<double> lengths(std::span<const double> errors) const;

  // By parameter in its own unit, of errors from at().
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

// Points of Sobol's sequence over the range that are inside, and those in a quarter of it around
// and in the range that are not; [count x d].
std::vector<double> places_within(const rbf::WeightFunction& function, int count,
                                  std::uint64_t seed, const rbf::Inside& inside);
std::vector<double> places_around(const rbf::WeightFunction& function, int count,
                                  std::uint64_t seed, const rbf::Inside& inside);

// A scaled place in own units.
void unscale(const rbf::WeightFunction& function, std::span<const double> place,
             std::span<double> point);

}  // namespace krok::fit::detail
