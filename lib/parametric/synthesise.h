#pragma once

#include <span>
#include <vector>

#include "parametric/blended_motion.h"
#include "parametric/bounds.h"
#include "parametric/measure.h"
#include "rbf/weight_evaluator.h"

namespace krok::parametric {

struct SynthesisOptions {
  bool extrapolate = false;  // parameters outside the bounds are no error
  // Steps of correction at run time, at most: Gauss-Newton on the weights, from those that the
  // weight function gives.
  int corrections = 0;
};

struct Synthesis {
  std::vector<double> weights;     // [examples], summing to 1
  std::vector<double> parameters;  // measured on the motion: metres, radians, seconds
  // The largest error of a parameter in its tolerances, before the correction and after.
  double error_before = 0, error = 0;
  int corrections = 0;  // steps taken
};

// A library made ready to be asked for motions: from parameters to weights to the motion.
class Synthesiser {
 public:
  // `library` must outlive it. Codes: those of check(Library) and of WeightEvaluator::create(),
  // parametric-weights where the weight function is for other numbers of examples or parameters.
  static Result<Synthesiser> create(const Library& library, const rbf::WeightFunction& weights);

  const Library& library() const { return *library_; }
  const PackedExamples& packed() const { return packed_; }
  const Measure& measure() const { return measure_; }
  const Bounds& bounds() const { return bounds_; }

  // The weights for parameters, [dimensions]. A correction step is the shortest change of the
  // weights, of those that sum to 0, that would bring the motion's own parameters (each in its
  // tolerance) to what was asked if they went straight; it is halved, up to four times, where they
  // come no nearer, and ends where they are within a hundredth of the tolerance. Codes:
  // parametric-bounds outside the bounds, with the nearest parameters inside; those of Measure.
  Result<Synthesis> weights(std::span<const double> parameters,
                            const SynthesisOptions& options = {}) const;

  // The motion for weights, as BlendedMotion has it; views this object.
  Result<BlendedMotion> motion(std::span<const double> weights) const {
    return BlendedMotion::create(*library_, packed_, weights);
  }

 private:
  Synthesiser(const Library& library, PackedExamples packed, rbf::WeightEvaluator evaluator);
  double error_of(std::span<const double> parameters, std::span<const double> measured) const;
  Status correct(std::span<const double> parameters, int steps, Synthesis& synthesis) const;

  const Library* library_;
  PackedExamples packed_;
  Measure measure_;
  Bounds bounds_;
  rbf::WeightEvaluator evaluator_;
};

}  // namespace krok::parametric
