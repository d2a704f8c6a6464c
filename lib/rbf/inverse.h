#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/result.h"
#include "rbf/weight_evaluator.h"

// From parameters that are wanted to weights whose blend has them. What a blend with weights w
// really has, f(w), is measured; f(w(p)) is not quite p.

namespace krok::rbf {

// Measures the parameters f(w), [d] in their own units, of a blend with weights that sum to 1, and,
// unless it is empty, the Jacobian d f_a / d w_i as [d x examples], of which only the part along
// changes that keep the sum is used. Must be safe to call from several threads. An error means that
// these weights give no motion; it is not the end of a search.
using Measure = std::function<Status(std::span<const double> weights, std::span<double> parameters,
                                     std::span<double> jacobian)>;

// How near a search came. Errors are |f(w) - wanted| with each parameter scaled by its range.
struct Match {
  double before = 0;  // infinite where f failed at the start
  double after = 0;
  int measured = 0;  // how often f was measured
};

// Holds memory for the search, so that no call takes any; one for each thread. The evaluator
// outlives it.
class InverseSearch {
 public:
  InverseSearch(const WeightEvaluator& evaluator, Measure measure);

  // Moves weights, which sum to 1 and go on to, by up to `steps` Gauss-Newton steps of least length
  // towards f(w) = wanted; a step that makes the error larger is shortened, and then left out.
  // Stops when the error is at most `enough`.
  Match correct(std::span<const double> wanted, int steps, double enough,
                std::span<double> weights);

  // Moves a point, [d] in own units, so that f(w(point)) = wanted, by Newton's method with damping
  // (Levenberg-Marquardt); it stays within half a range of the parameters' range. At most `steps`.
  Match find_point(std::span<const double> wanted, int steps, double enough,
                   std::span<double> point);

  // Weights for `wanted` from w(wanted): by find_point() if that is enough, and by correct() from
  // there on.
  Match weights_for(std::span<const double> wanted, double enough, std::span<double> weights);

 private:
  // Measures and returns the scaled error, which is infinite if that fails.
  double measure_at(std::span<const double> weights, std::span<const double> wanted, bool slopes,
                    std::vector<double>& error);
  // The same for weights at a point.
  double measure_point(std::span<const double> point, std::span<const double> wanted, bool slopes,
                       std::vector<double>& error);

  const WeightEvaluator& evaluator_;
  Measure measure_;
  std::size_t d_, n_;
  int measured_ = 0;
  std::vector<double> parameters_, jacobian_;         // what f gave, scaled
  std::vector<double> error_, tried_error_;           // [d], wanted - f, scaled
  std::vector<double> weights_, slopes_, direction_;  // [N], [d x N], [N]
  std::vector<double> point_, wanted_point_;          // [d]
};

}  // namespace krok::rbf
