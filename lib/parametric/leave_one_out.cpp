#include "parametric/leave_one_out.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "parametric/bounds.h"
#include "parametric/left_out_internal.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"

namespace krok::parametric {

namespace {

// A library without one of its examples, and that example.
struct Gap {
  Library others;
  PackedExamples packed;
  std::vector<double> point;  // parameters of the example
  std::vector<Vec3> wanted;
};

Gap gap_of(const Library& library, std::size_t index) {
  Gap gap;
  gap.wanted = detail::example_poses(library, index);
  gap.point = library.examples[index].parameters;
  std::vector<Example> others;
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    if (i != index) others.push_back(library.examples[i]);
  }
  gap.others = library.with(std::move(others));
  gap.packed = pack_examples(gap.others);
  return gap;
}

// Distance of the motion by the weight function of the others.
std::optional<double> weighted_distance(const Gap& gap, rbf::Kernel kernel, double smoothing) {
  const auto weights = rbf::point_weights(
      gap.others.dimensions(), detail::parameters_of(gap.others), kernel, smoothing, gap.point);
  if (!weights) return std::nullopt;
  return detail::distance(gap.others, gap.packed, *weights, gap.wanted);
}

HeldOut hold_out(const Library& library, std::size_t index, rbf::Kernel kernel, double smoothing) {
  const Gap gap = gap_of(library, index);
  const Bounds bounds = bounds_of(gap.others);
  HeldOut result;
  result.example = static_cast<int>(index);
  result.inside = outside(bounds, gap.point).distance == 0;
  const auto of = [&](const std::vector<double>& weights) {
    return detail::distance(gap.others, gap.packed, weights, gap.wanted);
  };
  const auto weighted = weighted_distance(gap, kernel, smoothing);
  const auto linear = of(detail::plane_weights(bounds, gap.point));
  const auto nearest = of(detail::nearest_weights(bounds, gap.point));
  result.failed = !weighted || !linear || !nearest;
  if (result.failed) return result;
  result.weighted = *weighted;
  result.linear = *linear;
  result.nearest = *nearest;
  return result;
}

}  // namespace

Result<std::vector<HeldOut>> leave_one_out(const Library& library, rbf::Kernel kernel,
                                           double smoothing, int jobs) {
  if (Status status = check(library); !status) return status.error();
  if (const auto all = detail::weights_of(library, kernel, smoothing); !all) return all.error();
  std::vector<HeldOut> results(library.examples.size());
  parallel_for(results.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      results[i] = hold_out(library, i, kernel, smoothing);
    }
  });
  return results;
}

LeftOutMeans means_of(std::span<const HeldOut> left_out) {
  LeftOutMeans means;
  for (const HeldOut& one : left_out) {
    if (!one.inside || one.failed) continue;
    ++means.examples;
    means.weighted += one.weighted;
    means.linear += one.linear;
    means.nearest += one.nearest;
  }
  for (double* mean : {&means.weighted, &means.linear, &means.nearest}) {
    *mean /= std::max(1, means.examples);
  }
  return means;
}

Result<std::vector<double>> distances_to_examples(const Library& library,
                                                  const rbf::WeightFunction& function) {
  if (Status status = check(library); !status) return status.error();
  const auto evaluator = rbf::WeightEvaluator::create(function);
  if (!evaluator) return evaluator.error();
  if (function.examples != static_cast<int>(library.examples.size()) ||
      function.dimensions != library.dimensions()) {
    return Error("parametric-weights",
                 "the weight function has another number of examples or parameters");
  }
  const PackedExamples packed = pack_examples(library);
  std::vector<double> weights(library.examples.size()), distances;
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    evaluator->weights(library.examples[i].parameters, weights);
    distances.push_back(
        detail::distance(library, packed, weights, detail::example_poses(library, i))
            .value_or(std::numeric_limits<double>::infinity()));
  }
  return distances;
}

}  // namespace krok::parametric
