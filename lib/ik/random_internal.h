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

// Turns a joint for another start: a hinge to anywhere in its range, others by up to a radian about
// each axis, within their limits.
inline void turn_at_random(ChainJoint& joint, Random& random) {
  if (joint.is_hinge()) {
    joint.set_twist(random.between(joint.limit->min_twist, joint.limit->max_twist));
    return;
  }
  const Vec3 turn(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  joint.set_local((joint.local * from_rotation_vector(turn)).normalized());
}

}  // namespace krok::ik
