#pragma once

#include <cstdint>

#include "ik/tree_internal.h"
#include "math/quaternion.h"

namespace krok::ik {

// SplitMix64 (Steele, Lea and Flood 2014): the same numbers on every machine.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream)
      : state_(seed * 0x9E3779B97F4A7C15u + stream * 0xD1B54A32D192ED03u) {}

  // In [0, 1).
  double unit() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * unit(); }

 private:
  std::uint64_t state_;
};

// A joint's rotation for another start: a hinge's anywhere in its range, others within a radian of
// where they are, within their limits.
inline Quat random_rotation(const ChainJoint& joint, Random& random) {
  if (joint.is_hinge()) {
    const JointLimit& limit = *joint.limit;
    return compose(limit, random.between(limit.min_twist, limit.max_twist), {0, 0});
  }
  const Vec3 turn(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  const Quat turned = (joint.local * from_rotation_vector(turn)).normalized();
  return joint.limit ? clamped(*joint.limit, turned) : turned;
}

}  // namespace krok::ik
