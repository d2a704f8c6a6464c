#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/result.h"
#include "math/types.h"
#include "render/colour.h"
#include "render/texture.h"

// What pictures are made of: a figure at one moment, in the world, metres.

namespace krok::render {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// Both sides of a triangle are seen.
struct Surface {
  std::vector<Vec3f> positions;                  // [vertices]
  std::vector<Vec3f> normals;                    // [vertices], or none: flat triangles
  std::shared_ptr<const Triangles> triangles;    // shared by the moments of a figure
  std::vector<Colour> colours;                   // [vertices], or one for all of them
  std::shared_ptr<const Paint> paint = nullptr;  // stands in for the colours where there is one
};

// A bar with round ends, or a ball where both ends are in one place.
struct Bone {
  Vec3f from = Vec3f::Zero(), to = Vec3f::Zero();
  float from_radius = 0, to_radius = 0;
  Colour from_colour, to_colour;
};

struct Actor {
  std::vector<Surface> surfaces;
  std::vector<Bone> bones;
  // The point of the ground (y = 0) at which it stands; what a camera that goes along follows.
  Vec3 centre = Vec3::Zero();

  bool empty() const { return surfaces.empty() && bones.empty(); }
};

// Whether shapes agree, triangles name vertices that exist, values are finite and no larger than
// 1e15, radii not negative, and a paint has what it promises. Code render-figure.
Status check(const Actor& actor);

// The box around all vertices and bones. Nothing in an empty figure; then the box is around its
// centre.
struct Bounds {
  Vec3 low, high;
  double extent() const { return (high - low).maxCoeff(); }
};
Bounds bounds(const Actor& actor);

}  // namespace krok::render
