#pragma once

#include <cstdint>
#include <span>

#include "samples/generator/walk_options.h"

namespace krok::samples {

// Gaussian random numbers, identical on every machine for a given seed (SplitMix64 and Box-Muller;
// standard library distributions differ between implementations).
class NoiseSource {
 public:
  explicit NoiseSource(std::uint64_t seed) : state_(seed) {}
  double gaussian();

 private:
  double uniform();  // in (0, 1]
  std::uint64_t state_;
};

// Adds the measurement noise of the options to a pose (joint_to_world): to each joint's local
// rotation and to the root position. Bone lengths are kept. Without noise the pose is unchanged.
void add_noise(const WalkOptions& options, const Skeleton& skeleton, NoiseSource& noise,
               std::span<Transform> joint_to_world);

}  // namespace krok::samples
