#pragma once

#include <cstdint>
#include <span>

#include "samples/generator/walk_options.h"

namespace krok::samples {

// Gaussian numbers, the same on every machine for the same seed (SplitMix64 and Box-Muller; the
// standard library's distributions differ between implementations).
class NoiseSource {
 public:
  explicit NoiseSource(std::uint64_t seed) : state_(seed) {}
  double gaussian();

 private:
  double uniform();  // in (0, 1]
  std::uint64_t state_;
};

// Adds the options' measuring noise to a pose (joint_to_world): each joint's rotation to its
// parent, and the root's position. Bones keep their lengths. Without noise in the options nothing
// changes.
void add_noise(const WalkOptions& options, const Skeleton& skeleton, NoiseSource& noise,
               std::span<Transform> joint_to_world);

}  // namespace krok::samples
