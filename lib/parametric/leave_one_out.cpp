#include "parametric/leave_one_out.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "math/dense_solve.h"
#include "parametric/blended_motion.h"
#include "rbf/weight_evaluator.h"

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

namespace krok::parametric::detail {

namespace {

constexpr int kParts = 16;  // samples per interval between keytimes

// Positions at fractions of a motion's intervals, [samples x joints], without the joints above the
// hips.
std::vector<Vec3> poses_of(const BlendedMotion& motion, const PackedExamples& packed) {
  const Skeleton& skeleton = packed.skeleton;
  const std::vector<std::uint8_t>& below = packed.hips_root.below();
  auto scratch = motion.make_scratch();
  std::vector<PoseBlock> pose(scratch.reference.size());
  std::vector<Transform> world(skeleton.names.size());
  std::vector<Vec3> positions;
  const auto& keytimes = motion.keytimes();
  for (std::size_t k = 0; k + 1 < keytimes.size(); ++k) {
    for (int part = 0; part < kParts; ++part) {
      const double lasts = keytimes[k + 1] - keytimes[k];
      motion.pose(keytimes[k] + lasts * (part + 0.5) / kParts, pose, scratch);
      unpack_pose(pose, world);
      local_to_world(skeleton.parents, world, world);
      for (std::size_t j = 0; j < below.size(); ++j) {
        if (below[j] != 0) positions.push_back(world[j].position);
      }
    }
  }
  return positions;
}

}  // namespace

std::vector<double> parameters_of(const Library& library) {
  std::vector<double> all;
  for (const Example& example : library.examples) {
    all.insert(all.end(), example.parameters.begin(), example.parameters.end());
  }
  return all;
}

Result<rbf::WeightFunction> weights_of(const Library& library, rbf::Kernel kernel,
                                       double smoothing) {
  rbf::SolverOptions options;
  options.kernel = kernel;
  options.smoothing = smoothing;
  const auto solver =
      rbf::WeightSolver::create(library.dimensions(), parameters_of(library), options);
  if (!solver) return solver.error();
  return solver->function();
}

std::vector<double> plane_weights(const Bounds& bounds, std::span<const double> point) {
  const Eigen::Index d = bounds.dimensions;
  const auto n = static_cast<Eigen::Index>(bounds.points.size()) / d;
  Eigen::MatrixXd planes(n, d + 1);
  planes.col(0).setOnes();
  planes.rightCols(d) = Eigen::Map<const Eigen::MatrixXd>(bounds.points.data(), d, n).transpose();
  Eigen::VectorXd at(d + 1);
  at[0] = 1;
  bounds.scale(point, {at.data() + 1, static_cast<std::size_t>(d)});
  const Eigen::VectorXd weights = solve_minimum_norm(planes.transpose(), at);
  return {weights.begin(), weights.end()};
}

std::vector<double> nearest_weights(const Bounds& bounds, std::span<const double> point) {
  const auto d = static_cast<std::size_t>(bounds.dimensions);
  std::vector<double> scaled(d), weights(bounds.points.size() / d, 0);
  bounds.scale(point, scaled);
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    double square = 0;
    for (std::size_t k = 0; k < d; ++k) {
      square += (bounds.points[i * d + k] - scaled[k]) * (bounds.points[i * d + k] - scaled[k]);
    }
    if (square >= least) continue;
    least = square;
    best = i;
  }
  weights[best] = 1;
  return weights;
}

std::optional<double> distance(const Library& library, const PackedExamples& packed,
                               std::span<const double> weights, const std::vector<Vec3>& wanted) {
  const auto motion = BlendedMotion::create(library, packed, weights);
  if (!motion) return std::nullopt;
  const auto found = poses_of(*motion, packed);
  double sum = 0;
  for (std::size_t i = 0; i < found.size(); ++i) sum += (found[i] - wanted[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(found.size()));
}

std::size_t samples_of(const Library& library) {
  return kParts * (library.keytimes.size() - 1);
}

std::vector<Vec3> example_poses(const Library& library, std::size_t index) {
  const Library alone = library.with({library.examples[index]});
  const PackedExamples packed = pack_examples(alone);
  const double all = 1;
  return poses_of(*BlendedMotion::create(alone, packed, {&all, 1}), packed);
}

}  // namespace krok::parametric::detail
