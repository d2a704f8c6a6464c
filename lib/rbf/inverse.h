#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/result.h"
#include "rbf/weight_evaluator.h"

// Finds weights whose blend has the wanted parameters. The measured parameters f(w) of a blend
// differ from the request: f(w(p)) is only approximately p.

namespace krok::rbf {

// Measures the parameters f(w), [d] in their units, of a blend with weights that sum to 1, and, if
// `jacobian` is not empty, d f_a / d w_i as [d x examples]. Only its component along changes that
// keep the sum is used. Must be thread-safe. An error means that these weights give no motion; the
// search continues.
using Measure = std::function<Status(std::span<const double> weights, std::span<double> parameters,
                                     std::span<double> jacobian)>;

// Result of a search. Errors are |f(w) - wanted|, each parameter scaled by its range.
struct Match {
  double before = 0;  // infinity if f failed at the start
  double after = 0;
  int measured = 0;  // number of evaluations of f
};

// Owns the memory of the search, so that calls do not allocate. Use one per thread. The evaluator
// must outlive it.
class InverseSearch {
 public:
  InverseSearch(const WeightEvaluator& evaluator, Measure measure);

  // Moves weights that sum to 1 towards f(w) = wanted by up to `steps` minimum-norm Gauss-Newton
  // steps, which keep the sum. A step that increases the error is halved, then dropped. Stops when
  // the error is at most `enough`.
  Match correct(std::span<const double> wanted, int steps, double enough,
                std::span<double> weights);

  // Moves a point, [d] in parameter units, towards f(w(point)) = wanted by at most `steps` damped
  // Newton (Levenberg-Marquardt) steps. The point stays within half a range of the parameters'
  // range.
  Match find_point(std::span<const double> wanted, int steps, double enough,
                   std::span<double> point);

 private:
  // Measures and returns the scaled error; infinity on failure.
  double measure_at(std::span<const double> weights, std::span<const double> wanted, bool slopes,
                    std::vector<double>& error);
  // The same for the weights at a point.
  double measure_point(std::span<const double> point, std::span<const double> wanted, bool slopes,
                       std::vector<double>& error);

  const WeightEvaluator& evaluator_;
  Measure measure_;
  std::size_t d_, n_;
  int measured_ = 0;
  std::vector<double> parameters_, jacobian_;         // f, scaled
  std::vector<double> error_, tried_error_;           // [d], wanted - f, scaled
  std::vector<double> weights_, slopes_, direction_;  // [N], [d x N], [N]
  std::vector<double> point_;                         // [d]
};

}  // namespace krok::rbf
