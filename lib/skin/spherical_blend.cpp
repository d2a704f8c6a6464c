#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "math/types.h"
#include "skin/skin_job_internal.h"

// Spherical blend skinning, but for its blend itself (skin_scalar.cpp): sets of joints and their
// rotation centres.

namespace krok::skin_detail {

namespace {

// Added to squared singular values of 4 sin^2(angle / 2), so that the centre of joints that hardly
// turn against each other tends to the mean of the joints.
constexpr double kDamping = 1e-6;

struct Rotation {
  Mat3 matrix;
  Vec3 translation;

  explicit Rotation(const DualQuaternion& of) {
    const float* c = of.components;
    const Quat q = Quat(c[3], c[0], c[1], c[2]).normalized();
    const Quat dual(c[7], c[4], c[5], c[6]);
    matrix = q.toRotationMatrix();
    translation = 2 * (dual * q.conjugate()).vec();
  }
};

// x of the smallest sum over all pairs of |(R_a - R_b) x + t_a - t_b|^2, plus kDamping |x -
// start|^2.
Vec3 rotation_centre(std::span<const std::uint16_t> set, const std::vector<DualQuaternion>& motions,
                     const Vec3& start) {
  Mat3 a = kDamping * Mat3::Identity();
  Vec3 b = Vec3::Zero();
  for (std::size_t i = 0; i < set.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Rotation one(motions[set[i]]), other(motions[set[k]]);
      const Mat3 turn = one.matrix - other.matrix;
      a += turn.transpose() * turn;
      b -= turn.transpose() * (turn * start + one.translation - other.translation);
    }
  }
  Mat3 inverse;  // by cofactors; a is symmetric and positive definite
  inverse << a.col(1).cross(a.col(2)), a.col(2).cross(a.col(0)), a.col(0).cross(a.col(1));
  return start + inverse * b / a.col(0).dot(a.col(1).cross(a.col(2)));
}

}  // namespace

std::uint32_t SetNumbers::set(std::vector<std::uint16_t> joints) {
  std::ranges::sort(joints);
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  const auto [found, is_new] =
      sets_.emplace(std::move(joints), static_cast<std::uint32_t>(sets_.size()));
  if (is_new) binding_.sets.push_back(found->first);
  return found->second;
}

std::uint32_t SetNumbers::pair(std::uint32_t set, std::uint16_t joint) {
  const auto [found, is_new] =
      pairs_.emplace(std::pair(set, joint), static_cast<std::uint32_t>(pairs_.size()));
  if (is_new) {
    binding_.pairs.push_back({binding_.sets[set].front(), joint});
    binding_.pair_sets.push_back(set);
  }
  return found->second;
}

void fill_centres(Posed& pose) {
  const Binding& binding = *pose.binding;
  for (std::size_t s = 0; s < binding.sets.size(); ++s) {
    const auto& set = binding.sets[s];
    Vec3 start = binding.joint_to_world[set.front()].position;
    if (set.size() > 1) start.setZero();
    for (std::size_t k = 1; k < set.size(); ++k) {
      start += binding.joint_to_world[set[k]].position / static_cast<double>(set.size() - 1);
    }
    pose.set_centres[s] = rotation_centre(set, pose.motions, start);
  }
  for (std::size_t i = 0; i < binding.pairs.size(); ++i) {
    const Vec3& centre = pose.set_centres[binding.pair_sets[i]];
    const Rotation rotation(pose.motions[binding.pairs[i].joint]);
    const Vec3 moved = rotation.matrix * centre + rotation.translation - centre;
    float* components = pose.pair_motions[i].components;
    for (int k = 0; k < 3; ++k) components[4 + k] = static_cast<float>(moved[k]);
    components[7] = 0;
    pose.pair_centres[i] = centre.cast<float>();
  }
}

}  // namespace krok::skin_detail
