#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "render/image.h"
#include "render/texture.h"

// What is rendered: a character at one time, in world space, metres.

namespace krok::render {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// Rendered double-sided.
struct Surface {
  std::vector<Vec3f> positions;                // [vertices]
  std::vector<Vec3f> normals;                  // [vertices], or none for flat shading
  std::shared_ptr<const Triangles> triangles;  // shared by the frames of a character
  std::vector<Colour> colours;                 // [vertices], or one for all of them
  // If set, the colours of vertices multiply it; one for all is replaced.
  std::shared_ptr<const Paint> paint = nullptr;
};

// A capsule, or a ball if both ends coincide.
struct Bone {
  Vec3f from = Vec3f::Zero(), to = Vec3f::Zero();
  float from_radius = 0, to_radius = 0;
  Colour from_colour, to_colour;
};

struct Actor {
  std::vector<Surface> surfaces;
  std::vector<Bone> bones;
  // The ground point (y = 0) below the character; the target of a following camera.
  Vec3 centre = Vec3::Zero();

  bool empty() const { return surfaces.empty() && bones.empty(); }
};

// Whether array sizes agree, triangle indices are in range, values are finite with magnitudes up to
// 1e15, radii are not negative, and paints are valid. Code render-figure.
Status check(const Actor& actor);

// The bounding box of all vertices and bones; empty at the centre for an empty actor.
struct Bounds {
  Vec3 low, high;
  double extent() const { return (high - low).maxCoeff(); }
};
Bounds bounds(const Actor& actor);

}  // namespace krok::render
