#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/transform.h"

namespace krok {

// The volume enclosed by a surface, and its area.
struct MeshVolume {
  double volume = 0;    // cubic metres; negative if triangles are clockwise seen from outside
  double area = 0;      // square metres
  bool closed = false;  // if false, `volume` is meaningless
};

// For each vertex the first one at exactly the same position: files duplicate them at seams. NaN
// only matches itself.
std::vector<std::uint32_t> first_at_position(std::span<const Vec3> positions);

// By the divergence theorem: the sum over the triangles of a . (b x c) / 6, relative to the centre
// of the bounding box, so that a mesh far from the origin loses no precision. Closed means that
// each edge is used as often in one direction as in the other, where vertices at exactly the same
// position are merged (files duplicate them at seams). Overlapping parts count twice, inverted
// parts negatively. `triangles` are indices into `positions`. No triangles: all 0, not closed; NaN
// in positions that are used: NaN. Source: Zhang, Chen, Efficient Feature Extraction for 2D/3D
// Objects in Mesh Representation (ICIP 2001).
MeshVolume mesh_volume(std::span<const Vec3> positions,
                       std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace krok
