#pragma once

#include <cmath>

#include "scene/mesh_motion.h"
#include "scene/model.h"

namespace krok::test {

// A motion in which every vertex goes its own way, and its normal turns.
inline MeshMotion wobble(const Model& model, int frames) {
  MeshMotion result;
  result.frames = frames;
  result.rate = 25;
  result.source =
      copies_of([&model](int frame, std::span<Vec3f> positions, std::span<Vec3f> normals) {
        for (std::size_t v = 0; v < positions.size(); ++v) {
          const float angle = 0.01f * static_cast<float>(v % 100) * static_cast<float>(frame);
          positions[v] = model.positions[v] + Vec3f(std::sin(angle), 0, 1 - std::cos(angle));
          if (!normals.empty()) normals[v] = Vec3f(std::cos(angle), std::sin(angle), 0);
        }
      });
  return result;
}

}  // namespace krok::test
