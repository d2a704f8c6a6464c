#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "nodes/scene.h"

namespace krok::gltf {

// The vertices of `whole` that triangles use, in its order, and the triangles with their new
// numbers. Everything else that there is of vertices comes along; the material does not.
nodes::Primitive with_used_vertices(const nodes::Primitive& whole,
                                    std::vector<std::array<std::uint32_t, 3>> triangles);

// Of what with_used_vertices() copies, about.
std::size_t bytes_of(const nodes::Primitive& primitive);

}  // namespace krok::gltf
