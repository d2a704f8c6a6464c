#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

// Counter-clockwise seen from the side that can be stood on; metres, world.
using GroundTriangle = std::array<Vec3, 3>;

inline constexpr std::size_t kMaxGroundTriangles = 50'000'000;

// The triangles that face up as ground: others, the undersides of bridges and walls, do not carry.
// If triangles that face down cover more than twice as much, the winding is taken to be reversed
// and `reversed` (if given) is set. Along an edge that two triangles share there is no gap. Heights
// are computed in doubles. Found by a tree of boxes (Embree).
// Codes: ground-empty if nothing faces up; ground-value for corners that are not finite or farther
// than 1e6 m from the origin; ground-size for too many triangles.
Result<std::unique_ptr<Terrain>> mesh_ground(std::vector<GroundTriangle> triangles,
                                             bool* reversed = nullptr);

// All triangles of a ground made by mesh_ground(), those that do not carry too, to the accuracy of
// floats; empty for other kinds.
std::optional<std::vector<GroundTriangle>> triangles_of(const Terrain& ground);

}  // namespace krok::terrain
