#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "math/types.h"

namespace krok {

// The volume within a surface and its area.
struct MeshVolume {
  double volume = 0;    // cubic metres; less than 0 where triangles are clockwise seen from outside
  double area = 0;      // square metres
  bool closed = false;  // without it `volume` depends on where the origin is, and means nothing
};

// By the divergence theorem: the sum over the triangles of a . (b x c) / 6, with points taken from
// the middle of their box, so that a mesh far from the origin loses no digits. Closed means that
// each edge is passed as often in one direction as in the other, where vertices at exactly the same
// place count as one (files double those at seams). Parts that overlap count twice, a part turned
// inside out counts less than 0. `triangles` are places in `positions`. No triangles: all 0, not
// closed; NaN in positions that triangles name: NaN. Source: Zhang, Chen, Efficient Feature
// Extraction for 2D/3D Objects in Mesh Representation (ICIP 2001).
MeshVolume mesh_volume(std::span<const Vec3> positions,
                       std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace krok
