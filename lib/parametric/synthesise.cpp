#include "parametric/synthesise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text.h"
#include "math/dense_solve.h"

namespace krok::parametric {

namespace {

constexpr double kGoodEnough = 0.01;  // of the tolerances
constexpr int kHalvings = 4;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Formatted for messages: "step.length 0.8 m, step.turn 12 degrees".
std::string in_words(const Library& library, std::span<const double> parameters) {
  std::string text;
  for (std::size_t d = 0; d < parameters.size(); ++d) {
    const Parameter& parameter = library.parameters[d];
    const bool angle = unit_of(parameter) == "rad";
    text += fmt::format("{}{} {} {}", d == 0 ? "" : ", ",
                        name_of(parameter, library.skeleton, library.keytimes),
                        readable(angle ? parameters[d] / kRadiansPerDegree : parameters[d], 4),
                        angle ? "degrees" : unit_of(parameter));
  }
  return text;
}

// How far a weight is from the middle of its range.
double from_middle(double weight) {
  return std::abs(weight - 0.5 * (kMinWeight + kMaxWeight));
}

bool is_blend(std::span<const double> weights) {
  constexpr double kRoundingOfWeights = 1e-9;
  return std::ranges::all_of(weights, [](double weight) {
    return weight >= kMinWeight - kRoundingOfWeights && weight <= kMaxWeight + kRoundingOfWeights;
  });
}

}  // namespace

Synthesiser::Synthesiser(const Library& library, PackedExamples packed,
                         rbf::WeightEvaluator evaluator)
    : library_(&library),
      packed_(std::move(packed)),
      measure_(library, packed_),
      bounds_(bounds_of(library)),
      evaluator_(std::move(evaluator)) {}

Result<Synthesiser> Synthesiser::create(const Library& library,
                                        const rbf::WeightFunction& weights) {
  if (Status status = check(library); !status) return status.error();
  if (weights.examples != static_cast<int>(library.examples.size()) ||
      weights.dimensions != library.dimensions()) {
    return Error("parametric-weights",
                 fmt::format("the weight function is for {} examples with {} parameters, the "
                             "library has {} with {}",
                             weights.examples, weights.dimensions, library.examples.size(),
                             library.dimensions()),
                 "fit the library again");
  }
  auto evaluator = rbf::WeightEvaluator::create(weights);
  if (!evaluator) return evaluator.error();
  return Synthesiser(library, pack_examples(library), *std::move(evaluator));
}

double Synthesiser::error_of(std::span<const double> parameters,
                             std::span<const double> measured) const {
  double largest = 0;
  for (std::size_t d = 0; d < parameters.size(); ++d) {
    largest = std::max(largest,
                       std::abs(measured[d] - parameters[d]) / library_->parameters[d].tolerance);
  }
  return largest;
}

Result<Synthesis> Synthesiser::weights(std::span<const double> parameters,
                                       const SynthesisOptions& options) const {
  if (parameters.size() != library_->parameters.size()) {
    return Error("parametric-bounds", fmt::format("got {} parameters, the library has {}",
                                                  parameters.size(), library_->dimensions()));
  }
  const Outside off = outside(bounds_, parameters);
  if (off.distance > 0 && !(options.extrapolate && std::isfinite(off.distance))) {
    // Without the margin, so that they are still inside when rounded to the digits of a message.
    Bounds examples = bounds_;
    examples.margin = 0;
    return Error(
        "parametric-bounds",
        fmt::format("{} is outside the range of the examples", in_words(*library_, parameters)),
        "the nearest parameters inside are " +
            in_words(*library_, outside(examples, parameters).nearest));
  }
  Synthesis synthesis;
  synthesis.weights.resize(library_->examples.size());
  synthesis.parameters.resize(parameters.size());
  evaluator_.weights(parameters, synthesis.weights);
  auto scratch = measure_.make_scratch();
  if (Status status = measure_(synthesis.weights, synthesis.parameters, {}, scratch); !status) {
    return status.error();
  }
  synthesis.error = synthesis.error_before = error_of(parameters, synthesis.parameters);
  if (Status status = correct(parameters, options, synthesis); !status) {
    return status.error();
  }
  if (options.extrapolate || is_blend(synthesis.weights)) return synthesis;
  const auto worst = std::ranges::max_element(synthesis.weights, {}, from_middle);
  const auto& name =
      library_->examples[static_cast<std::size_t>(worst - synthesis.weights.begin())].name;
  return Error(
      "parametric-extrapolation",
      fmt::format("{} needs a weight of {} for {}; {} to {} are safe",
                  in_words(*library_, parameters), readable(*worst, 3), shown(name), kMinWeight,
                  kMaxWeight),
      "add examples near these parameters, or smooth the weights with krok-fit --smoothing");
}

Status Synthesiser::correct(std::span<const double> parameters, const SynthesisOptions& options,
                            Synthesis& synthesis) const {
  const auto n = static_cast<Eigen::Index>(synthesis.weights.size());
  const auto d = static_cast<Eigen::Index>(parameters.size());
  auto scratch = measure_.make_scratch();
  RowMajor jacobian(d, n);
  std::vector<double> weights(synthesis.weights.size()), measured(parameters.size());
  const auto size = static_cast<std::size_t>(jacobian.size());
  for (int step = 0; step < options.corrections && synthesis.error > kGoodEnough; ++step) {
    if (Status status = measure_(synthesis.weights, measured, {jacobian.data(), size}, scratch);
        !status) {
      return status;
    }
    Eigen::VectorXd missing(d);
    for (Eigen::Index k = 0; k < d; ++k) {
      const auto p = static_cast<std::size_t>(k);
      const double scale = 1 / library_->parameters[p].tolerance;
      missing[k] = (parameters[p] - measured[p]) * scale;
      // Subtracting the mean restricts the row to changes that sum to 0.
      jacobian.row(k).array() -= jacobian.row(k).mean();
      jacobian.row(k) *= scale;
    }
    const Eigen::VectorXd change = solve_minimum_norm(jacobian, missing);
    bool nearer = false;
    double part = 1;
    for (int halving = 0; halving <= kHalvings && !nearer; ++halving, part *= 0.5) {
      for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i] = synthesis.weights[i] + part * change[static_cast<Eigen::Index>(i)];
      }
      if (!options.extrapolate && !is_blend(weights)) continue;
      if (!measure_(weights, measured, {}, scratch)) continue;
      nearer = error_of(parameters, measured) < synthesis.error;
    }
    if (!nearer) break;
    synthesis.weights = weights;
    synthesis.parameters = measured;
    synthesis.error = error_of(parameters, measured);
    ++synthesis.corrections;
  }
  return {};
}

}  // namespace krok::parametric
