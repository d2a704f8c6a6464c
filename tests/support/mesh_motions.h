#pragma once

#include <cmath>

#include "scene/mesh_motion.h"
#include "scene/model.h"

namespace krok::test {

// A motion in which vertices move differently, and their normals and tangents turn.
inline MeshMotion wobble(const Model& model, int frames) {
  MeshMotion result;
  result.frames = frames;
  result.rate = 25;
  result.source = copies_of([&model](int frame, const ShapeOutput& to) {
    for (std::size_t v = 0; v < to.positions.size(); ++v) {
      const float angle = 0.01f * static_cast<float>(v % 100) * static_cast<float>(frame);
      to.positions[v] = model.positions[v] + Vec3f(std::sin(angle), 0, 1 - std::cos(angle));
      if (!to.normals.empty()) to.normals[v] = Vec3f(std::cos(angle), std::sin(angle), 0);
      if (!to.tangents.empty()) to.tangents[v] = Vec4f(-std::sin(angle), std::cos(angle), 0, -1);
    }
  });
  return result;
}

}  // namespace krok::test
