#include "samples/generator/noise.h"

#include <cmath>
#include <vector>

#include "math/quaternion.h"

namespace krok::samples {

double NoiseSource::uniform() {
  state_ += 0x9e3779b97f4a7c15u;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return (static_cast<double>(z >> 11) + 1.0) * 0x1.0p-53;
}

double NoiseSource::gaussian() {
  const double radius = std::sqrt(-2 * std::log(uniform()));
  return radius * std::cos(2 * kPi * uniform());
}

void add_noise(const WalkOptions& options, const Skeleton& skeleton, NoiseSource& noise,
               std::span<Transform> joint_to_world) {
  if (options.noise_angle == 0 && options.noise_position == 0) return;
  const auto vector = [&](double deviation) {
    const double x = noise.gaussian(), y = noise.gaussian(), z = noise.gaussian();
    return Vec3(Vec3(x, y, z) * deviation);
  };
  std::vector<Transform> local(joint_to_world.size());
  world_to_local(skeleton.parents, joint_to_world, local);
  local[0].position += vector(options.noise_position);
  for (std::size_t joint = 0; joint < local.size(); ++joint) {
    if (skeleton.end_sites[joint]) continue;
    // Each of the three components has the requested deviation.
    local[joint].orientation =
        local[joint].orientation * from_rotation_vector(vector(options.noise_angle));
  }
  local_to_world(skeleton.parents, local, joint_to_world);
}

}  // namespace krok::samples
