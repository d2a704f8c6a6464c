#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"
#include "scene/material.h"
#include "scene/model.h"

namespace krok {

// Tangents of a mesh that has none: at each vertex the direction in which u grows, in the plane of
// the normal and of length 1, the mean over the vertex's triangles with the angles at it as
// weights; w is the side of normal x tangent on which v falls (the top of the picture; v points
// down), -1 or 1, by the greater part of the triangles. Where texture coordinates give no direction
// it is some direction in the plane.
//
// `positions`, `normals` (of length 1) and `coordinates` have [vertices] elements, all finite.
// MikkTSpace's result but for vertices at which mirrored parts of the texture meet, which it
// splits. Source: Mikkelsen, Simulation of Wrinkled Surfaces Revisited (2008), section 2.
std::vector<Vec4f> make_tangents(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                                 std::span<const Vec2f> coordinates,
                                 std::span<const std::array<std::uint32_t, 3>> triangles);

// Whether some part of the model has a material with a normal texture, and all that its tangents
// are made of is there.
bool needs_tangents(const Model& model, std::span<const Material> materials);

}  // namespace krok
