#pragma once

#include <span>
#include <vector>

#include "parametric/blended_motion.h"
#include "parametric/bounds.h"
#include "parametric/measure.h"
#include "rbf/weight_evaluator.h"

namespace krok::parametric {

struct SynthesisOptions {
  // Allow parameters outside the bounds, and weights outside [kMinWeight, kMaxWeight].
  bool extrapolate = false;
  // Max run-time correction steps: Gauss-Newton on the weights, starting from those of the weight
  // function.
  int corrections = 0;
};

// Beyond these a motion is no blend of the examples any more: rotations and timing are carried on
// to where no example is.
constexpr double kMinWeight = -0.25, kMaxWeight = 1.25;

struct Synthesis {
  std::vector<double> weights;     // [examples], summing to 1
  std::vector<double> parameters;  // measured on the motion: metres, radians, seconds
  // Largest error of a parameter, in multiples of its tolerance, before and after correction.
  double error_before = 0, error = 0;
  int corrections = 0;  // steps taken
};

// A library prepared for synthesis: from parameters to weights to motion.
class Synthesiser {
 public:
  // `library` must outlive it. Codes: those of check(Library) and WeightEvaluator::create();
  // parametric-weights if the weight function has another number of examples or parameters.
  static Result<Synthesiser> create(const Library& library, const rbf::WeightFunction& weights);

  const Library& library() const { return *library_; }
  const PackedExamples& packed() const { return packed_; }
  const Measure& measure() const { return measure_; }
  const Bounds& bounds() const { return bounds_; }

  // Weights for parameters, [dimensions]. A correction is the minimum-norm change of the weights,
  // with sum 0, that to first order brings the measured parameters (scaled by tolerance) to the
  // request. It is halved up to four times while the error does not shrink; correction stops at a
  // hundredth of the tolerance, or before weights leave their range. Codes: parametric-bounds
  // outside the bounds, with the nearest parameters inside; parametric-extrapolation if weights are
  // outside their range; those of Measure.
  Result<Synthesis> weights(std::span<const double> parameters,
                            const SynthesisOptions& options = {}) const;

  // The largest difference of parameters, in multiples of their tolerances.
  double error_of(std::span<const double> parameters, std::span<const double> measured) const;

  // The motion for weights, see BlendedMotion; refers to this object.
  Result<BlendedMotion> motion(std::span<const double> weights) const {
    return BlendedMotion::create(*library_, packed_, weights);
  }

 private:
  Synthesiser(const Library& library, PackedExamples packed, rbf::WeightEvaluator evaluator);
  Status correct(std::span<const double> parameters, const SynthesisOptions& options,
                 Synthesis& synthesis) const;

  const Library* library_;
  PackedExamples packed_;
  Measure measure_;
  Bounds bounds_;
  rbf::WeightEvaluator evaluator_;
};

}  // namespace krok::parametric
