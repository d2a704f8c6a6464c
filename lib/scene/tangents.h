#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"
#include "scene/material.h"
#include "scene/model.h"

namespace krok {

// Computes tangents of a mesh. The tangent of a vertex is the direction of increasing u in the
// normal plane, of length 1, averaged over the vertex's triangles weighted by their angles at it.
// w, 1 or -1, is the side of normal x tangent on which v decreases (the top of the image; v points
// down), by majority of the triangles. If texture coordinates give no direction, it is any
// direction in the plane.
//
// `positions`, `normals` (of length 1) and `coordinates` have [vertices] elements, all finite. Same
// result as MikkTSpace except at vertices where mirrored parts of the texture meet, which it
// splits. Source: Mikkelsen, Simulation of Wrinkled Surfaces Revisited (2008), section 2.
std::vector<Vec4f> make_tangents(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                                 std::span<const Vec2f> coordinates,
                                 std::span<const std::array<std::uint32_t, 3>> triangles);

// Whether some part of the model has a material with a normal texture, and the data to compute
// tangents from is present.
bool needs_tangents(const Model& model, std::span<const Material> materials);

}  // namespace krok
