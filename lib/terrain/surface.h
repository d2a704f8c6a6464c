#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

// The surface of a ground as triangles, to be drawn. A corner at a sharp edge (faces that meet at
// more than 30 degrees) is there once for each side, so that shading keeps the edge.
struct Surface {
  std::vector<Vec3f> positions;  // metres, world
  std::vector<Vec3f> normals;    // unit vectors, [positions]
  // Counter-clockwise seen from above; walls have both ways.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct SurfaceOptions {
  Vec2 low = Vec2(-1, -1), high = Vec2(1, 1);  // x and z of the corners of a rectangle, metres
  double tolerance = 0.0005;  // metres; it is met as far as the limit of triangles allows
  std::int64_t triangles =
      200'000;  // limit of heights over the ground; a mesh has up to four times
};

// The surface in a rectangle. A mesh has its own triangles, cut at the rectangle, walls and
// undersides too. Other kinds are sampled on lines along X and Z, which lie where the ground needs
// them: both sides of the edge of a step, with a wall between, on a crease, round a hole, and close
// where it is rough. A mesh of too many triangles is sampled likewise, from above.
// Codes: ground-value for a rectangle that is empty or not finite; ground-empty if there is no
// ground in it.
Result<Surface> surface_of(const Terrain& ground, const SurfaceOptions& options);

}  // namespace krok::terrain
