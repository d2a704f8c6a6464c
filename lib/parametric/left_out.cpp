#include "parametric/left_out_internal.h"

#include <cmath>
#include <limits>

#include "math/dense_solve.h"
#include "parametric/blended_motion.h"

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
