#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/transform.h"

// Vertex normals for meshes and shapes without normals.

namespace krok {

// Groups of vertices that share a normal: those with bit-identical position and, if given, normal,
// such as the duplicates along texture seams. Returns [vertices] the first vertex of each group.
std::vector<std::uint32_t> shading_groups(std::span<const Vec3f> positions,
                                          std::span<const Vec3f> normals);

// Area-weighted vertex normals over the triangles around each group. A vertex without any area
// around it gets +Y. Triangle indices must be in range; `groups` comes from shading_groups() for
// any shape of the mesh.
void normals_of(std::span<const std::array<std::uint32_t, 3>> triangles,
                std::span<const Vec3f> positions, std::span<const std::uint32_t> groups,
                std::span<Vec3f> normals);

// Normals of another shape of a mesh with known normals: adds the change of the area-weighted
// normals of normals_of() and normalises, so that normals, including hard edges, are unchanged
// where the surface is.
void moved_normals(std::span<const std::array<std::uint32_t, 3>> triangles,
                   std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                   std::span<const Vec3f> moved_positions, std::span<Vec3f> moved);

}  // namespace krok
