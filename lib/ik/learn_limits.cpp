#include "ik/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok::ik {

namespace {

constexpr double kStill = 0.05 * kRadiansPerDegree;
constexpr double kSameReference = 0.5 * kRadiansPerDegree;
// Floats in a clip round angles to about this.
constexpr double kRounding = 5e-7;

// joint_to_parent of a joint in all frames, in the hemisphere of the first.
std::vector<Quat> rotations_of(int joint, int parent, std::span<const Clip* const> clips) {
  std::vector<Quat> all;
  for (const Clip* clip : clips) {
    for (int f = 0; f < clip->frame_count(); ++f) {
      const auto frame = clip->frame_orientations(f);
      const Quat local =
          frame[at(parent)].cast<double>().conjugate() * frame[at(joint)].cast<double>();
      const Quat unit = normalized_or_identity(local);
      all.push_back(all.empty() ? unit : in_hemisphere_of(all.front(), unit));
    }
  }
  return all;
}

// Two passes of averaging in the tangent space are enough for a centre.
Quat mean_of(const std::vector<Quat>& rotations) {
  Quat mean = rotations.front();
  for (int pass = 0; pass < 4; ++pass) {
    Vec3 sum = Vec3::Zero();
    for (const Quat& q : rotations) sum += rotation_vector(mean.conjugate() * q);
    mean = (mean * from_rotation_vector(sum / static_cast<double>(rotations.size()))).normalized();
  }
  return mean;
}

// The direction in which a symmetric matrix stretches most, by powers; zero for the zero matrix.
Vec3 main_direction(Mat3 matrix) {
  const double trace = matrix.trace();
  if (!(trace > 1e-20)) return Vec3::Zero();
  matrix /= trace;
  // Squared eight times: the 256th power.
  for (int i = 0; i < 8; ++i) {
    matrix = Mat3(matrix * matrix);
    matrix /= matrix.trace();
  }
  int column = 0;
  matrix.colwise().squaredNorm().maxCoeff(&column);
  Vec3 direction = matrix.col(column).normalized();
  int largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction[largest] < 0 ? Vec3(-direction) : direction;
}

// Along the bone: to the mean of the children, or for a leaf on from the parent.
Vec3 bone_axis(const Skeleton& skeleton, int joint) {
  Vec3 sum = Vec3::Zero();
  for (int j = joint + 1; j < skeleton.joint_count(); ++j) {
    if (skeleton.parents[at(j)] == joint) sum += skeleton.reference_local(j).position;
  }
  if (sum.norm() < 1e-6) {
    const Transform local = skeleton.reference_local(joint);
    sum = local.orientation.conjugate() * local.position;
  }
  return sum.norm() < 1e-6 ? Vec3(Vec3::UnitY()) : Vec3(sum.normalized());
}

Vec3 swing_axis_of(const std::vector<Quat>& rotations, JointLimit limit) {
  int least = 0;
  limit.axis.cwiseAbs().minCoeff(&least);
  limit.swing_axis = limit.axis.cross(Vec3::Unit(least)).normalized();
  const Vec3 second = limit.axis.cross(limit.swing_axis);
  Mat3 spread = Mat3::Zero();
  for (const Quat& q : rotations) {
    const auto swing = measure(limit, q).swing;
    const Vec3 v = swing[0] * limit.swing_axis + swing[1] * second;
    spread += v * v.transpose();
  }
  const Vec3 main = main_direction(spread);
  if (main.isZero()) return limit.swing_axis;
  return (main - limit.axis * limit.axis.dot(main)).normalized();
}

// Whether all rotations are about one axis.
bool fit_hinge(const std::vector<Quat>& rotations, double margin, JointLimit& limit) {
  Mat3 spread = Mat3::Zero();
  for (const Quat& q : rotations) {
    const Vec3 v = rotation_vector(limit.zero.conjugate() * q);
    spread += v * v.transpose();
  }
  const Vec3 main = main_direction(spread);
  if (main.isZero()) return false;
  JointLimit hinge = limit;
  hinge.kind = JointLimit::Kind::hinge;
  hinge.axis = main;
  hinge.swing_axis = main.unitOrthogonal();
  hinge.min_twist = -kPi;
  hinge.max_twist = kPi;
  double lowest = 0, highest = 0;
  for (const Quat& q : rotations) {
    const LimitAngles angles = measure(hinge, q);
    if (angles.off_axis > kRounding) return false;
    lowest = std::min(lowest, angles.twist);
    highest = std::max(highest, angles.twist);
  }
  hinge.min_twist = std::max(-kPi, lowest - margin);
  hinge.max_twist = std::min(kPi, highest + margin);
  limit = hinge;
  return true;
}

void fit_cone(const std::vector<Quat>& rotations, double margin, JointLimit& limit) {
  limit.kind = JointLimit::Kind::cone;
  limit.swing_axis = swing_axis_of(rotations, limit);
  limit.min_twist = limit.max_twist = 0;
  limit.min_swing = limit.max_swing = {0, 0};
  std::vector<std::array<double, 2>> swings;
  for (const Quat& q : rotations) {
    const LimitAngles angles = measure(limit, q);
    swings.push_back(angles.swing);
    limit.min_twist = std::min(limit.min_twist, angles.twist);
    limit.max_twist = std::max(limit.max_twist, angles.twist);
    for (std::size_t i = 0; i < 2; ++i) {
      limit.min_swing[i] = std::min(limit.min_swing[i], angles.swing[i]);
      limit.max_swing[i] = std::max(limit.max_swing[i], angles.swing[i]);
    }
  }
  double largest = 1;
  for (const auto& swing : swings) {
    double square = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const double half = swing[i] < 0 ? limit.min_swing[i] : limit.max_swing[i];
      if (half != 0) square += swing[i] * swing[i] / (half * half);
    }
    largest = std::max(largest, std::sqrt(square));
  }
  for (std::size_t i = 0; i < 2; ++i) {
    limit.min_swing[i] = std::max(-kPi, limit.min_swing[i] * largest - margin);
    limit.max_swing[i] = std::min(kPi, limit.max_swing[i] * largest + margin);
  }
  limit.min_twist = std::max(-kPi, limit.min_twist - margin);
  limit.max_twist = std::min(kPi, limit.max_twist + margin);
}

JointLimit limit_of(const Skeleton& skeleton, int joint, std::span<const Clip* const> clips,
                    double margin) {
  JointLimit limit;
  const std::vector<Quat> rotations = rotations_of(joint, skeleton.parents[at(joint)], clips);
  limit.zero = mean_of(rotations);
  double largest = 0;
  for (const Quat& q : rotations) largest = std::max(largest, angle_between(limit.zero, q));
  if (largest <= kStill && margin == 0) {
    limit.kind = JointLimit::Kind::locked;
    return limit;
  }
  limit.axis = bone_axis(skeleton, joint);
  limit.swing_axis = limit.axis.unitOrthogonal();
  if (!fit_hinge(rotations, margin + kRounding, limit)) {
    fit_cone(rotations, margin + kRounding, limit);
  }
  return limit;
}

}  // namespace

Result<Limits> learn_limits(const Skeleton& skeleton, std::span<const Clip* const> clips,
                            const LearnOptions& options) {
  int frames = 0;
  for (const Clip* clip : clips) {
    const std::string difference = difference_in_structure(skeleton, clip->skeleton);
    if (!difference.empty()) {
      return Error("limits-skeleton",
                   fmt::format("the motions have different skeletons: {}", difference));
    }
    for (int j = 1; j < skeleton.joint_count(); ++j) {
      if (angle_between(skeleton.reference_local(j).orientation,
                        clip->skeleton.reference_local(j).orientation) > kSameReference) {
        return Error("limits-skeleton",
                     fmt::format("the motions' reference poses differ at joint '{}'",
                                 skeleton.names[at(j)]));
      }
    }
    frames += clip->frame_count();
  }
  if (frames == 0) return Error("limits-empty", "there are no frames to learn limits from");
  Limits limits(skeleton.names.size());
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    if (skeleton.end_sites[at(j)]) {
      limits[at(j)].kind = JointLimit::Kind::locked;
    } else {
      limits[at(j)] = limit_of(skeleton, j, clips, options.margin);
    }
  }
  return limits;
}

}  // namespace krok::ik
