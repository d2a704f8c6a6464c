#include "nodes/moving.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"

namespace krok::nodes {

bool changes(const Channel& channel) {
  const auto width = at(channel.width);
  const bool spline = channel.interpolation == Interpolation::cubic_spline;
  const std::size_t each = width * (spline ? 3 : 1);
  const float* const first = channel.values->data() + (spline ? width : 0);
  const std::size_t keys = each > 0 ? channel.values->size() / each : 0;
  for (std::size_t k = 1; k < keys; ++k) {
    const auto size = static_cast<Eigen::Index>(width);
    const Eigen::Map<const Eigen::ArrayXf> a(first, size), b(first + k * each, size);
    // A quaternion and its negative are one rotation.
    const float sign = channel.path == Path::rotation && (a * b).sum() < 0 ? -1.0f : 1.0f;
    const float size_of_key = std::max(a.abs().maxCoeff(), b.abs().maxCoeff());
    const float rounding = channel.path == Path::translation ? 1e-6f + 1e-5f * size_of_key : 1e-4f;
    if ((b - sign * a).abs().maxCoeff() > rounding) return true;
  }
  return false;
}

std::vector<char> moved_nodes(const Scene& scene, const Animation& animation) {
  std::vector<char> moved(scene.nodes.size(), 0);
  for (const Channel& channel : animation.channels) {
    char& node = moved[at(channel.node)];
    if (channel.path != Path::weights && node == 0 && changes(channel)) node = 1;
  }
  return moved;
}

std::size_t moved_count(const Scene& scene, const Animation& animation,
                        std::span<const int> nodes) {
  std::vector<char> moved = moved_nodes(scene, animation);
  std::size_t count = 0, above = 0;
  for (const int node : nodes) count += node >= 0 && moved[at(node)] != 0 ? 1 : 0;
  for (int node : nodes) {
    for (; count == 0 && node >= 0; node = scene.nodes[at(node)].parent) {
      above += moved[at(node)] != 0 ? 1 : 0;
      moved[at(node)] = 0;
    }
  }
  return count > 0 ? count : above;
}

std::size_t camera_count(const Scene& scene, const Animation& animation, int node) {
  const auto of = [](const std::vector<Channel>& channels, int target) {
    return static_cast<std::size_t>(std::ranges::count_if(channels, [&](const Channel& channel) {
      return channel.node == target && channel.path != Path::weights && changes(channel);
    }));
  };
  std::size_t count = of(animation.lenses, scene.nodes[at(node)].camera);
  for (; node >= 0; node = scene.nodes[at(node)].parent) count += of(animation.channels, node);
  return count;
}

std::size_t target_count(const Animation& animation) {
  std::size_t count = 0;
  for (const Channel& channel : animation.channels) {
    if (channel.path == Path::weights && changes(channel)) count += at(channel.width);
  }
  return count;
}

}  // namespace krok::nodes
