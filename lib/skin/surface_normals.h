#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"

// Normals of shapes of a mesh that come without any.

namespace krok {

// Which vertices of a mesh shade as one: those with the same position and, where there are any, the
// same normal, to the bit. A mesh that is cut along the seams of its texture has several there.
// [vertices] the first one of each group.
std::vector<std::uint32_t> shading_groups(std::span<const Vec3f> positions,
                                          std::span<const Vec3f> normals);

// The normals of a surface: at each vertex the mean over the triangles around its group, each
// counting by its area. A vertex without an area around it gets +Y. Indices of triangles are in
// range; `groups` is what shading_groups() gives for some shape of the mesh.
void normals_of(std::span<const std::array<std::uint32_t, 3>> triangles,
                std::span<const Vec3f> positions, std::span<const std::uint32_t> groups,
                std::span<Vec3f> normals);

// The normals of another shape of a mesh whose normals are known: each moves as far as what the
// triangles around it say, and is brought to length 1; so that it stays as it is where the surface
// does, hard edges and all.
void moved_normals(std::span<const std::array<std::uint32_t, 3>> triangles,
                   std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                   std::span<const Vec3f> moved_positions, std::span<Vec3f> moved);

}  // namespace krok
