#include "parametric/leave_one_out.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>

#include "parametric/blended_motion.h"
#include "parametric/bounds.h"
#include "rbf/weight_evaluator.h"

namespace krok::parametric {

namespace {

constexpr int kParts = 16;  // moments in an interval between keytimes

std::vector<double> parameters_of(const Library& library) {
  std::vector<double> all;
  for (const Example& example : library.examples) {
    all.insert(all.end(), example.parameters.begin(), example.parameters.end());
  }
  return all;
}

Result<rbf::WeightFunction> weights_of(const Library& library, rbf::Kernel kernel) {
  rbf::SolverOptions options;
  options.kernel = kernel;
  const auto solver =
      rbf::WeightSolver::create(library.dimensions(), parameters_of(library), options);
  if (!solver) return solver.error();
  return solver->function();
}

// What the least-squares hyperplanes through the examples' weights are at a point.
std::vector<double> plane_weights(const Bounds& bounds, std::span<const double> point) {
  const Eigen::Index d = bounds.dimensions;
  const auto n = static_cast<Eigen::Index>(bounds.points.size()) / d;
  Eigen::MatrixXd planes(n, d + 1);
  planes.col(0).setOnes();
  planes.rightCols(d) = Eigen::Map<const Eigen::MatrixXd>(bounds.points.data(), d, n).transpose();
  Eigen::VectorXd at(d + 1);
  at[0] = 1;
  bounds.scale(point, {at.data() + 1, static_cast<std::size_t>(d)});
  const Eigen::VectorXd weights = planes.transpose().completeOrthogonalDecomposition().solve(at);
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

// The poses of a motion at parts of its intervals, positions alone: [moments x joints].
std::vector<Vec3> poses_of(const BlendedMotion& motion, const Skeleton& skeleton) {
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
      for (const Transform& joint : world) positions.push_back(joint.position);
    }
  }
  return positions;
}

std::optional<double> distance(const Library& library, const PackedExamples& packed,
                               std::span<const double> weights, const std::vector<Vec3>& wanted) {
  const auto motion = BlendedMotion::create(library, packed, weights);
  if (!motion) return std::nullopt;
  const auto found = poses_of(*motion, library.skeleton);
  double sum = 0;
  for (std::size_t i = 0; i < found.size(); ++i) sum += (found[i] - wanted[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(found.size()));
}

HeldOut hold_out(const Library& library, std::size_t index, rbf::Kernel kernel) {
  HeldOut result;
  result.example = static_cast<int>(index);
  Library others = library, alone = library;
  alone.examples.assign(1, library.examples[index]);
  others.examples.erase(others.examples.begin() + static_cast<std::ptrdiff_t>(index));
  const PackedExamples packed_alone = pack_examples(alone);
  const double all = 1;
  const auto wanted =
      poses_of(*BlendedMotion::create(alone, packed_alone, {&all, 1}), library.skeleton);

  const auto& point = library.examples[index].parameters;
  const Bounds bounds = bounds_of(others);
  result.inside = outside(bounds, point).distance == 0;
  const PackedExamples packed = pack_examples(others);
  const auto function = weights_of(others, kernel);
  result.failed = true;
  if (!function) return result;
  const auto evaluator = rbf::WeightEvaluator::create(*function);
  if (!evaluator) return result;
  std::vector<double> weights(others.examples.size());
  evaluator->weights(point, weights);
  const auto weighted = distance(others, packed, weights, wanted);
  const auto linear = distance(others, packed, plane_weights(bounds, point), wanted);
  const auto nearest = distance(others, packed, nearest_weights(bounds, point), wanted);
  if (!weighted || !linear || !nearest) return result;
  result.failed = false;
  result.weighted = *weighted;
  result.linear = *linear;
  result.nearest = *nearest;
  return result;
}

}  // namespace

Result<std::vector<HeldOut>> leave_one_out(const Library& library, rbf::Kernel kernel) {
  if (Status sound = check(library); !sound) return sound.error();
  if (const auto all = weights_of(library, kernel); !all) return all.error();
  std::vector<HeldOut> results;
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    results.push_back(hold_out(library, i, kernel));
  }
  return results;
}

}  // namespace krok::parametric
