#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "body/lattice.h"

// Polygonisation and remeshing of the implicit surface.

namespace krok::body {

// Normal of a triangle, with twice its area as length.
inline Vec3 area_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a);
}

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
};

// Marching tetrahedra (Doi and Koide 1991) over the cubes of the lattice, each split into six
// tetrahedra around its main diagonal (Kuhn's subdivision), which match between cubes: the result
// is a closed 2-manifold for any values. The vertex order is deterministic.
Mesh polygonise(const Lattice& lattice, int jobs);

// Whether a closed 2-manifold is one component without handles.
bool is_sphere(const Mesh& mesh);

// Moves every vertex half-way to the mean of its neighbours.
void smooth(Mesh& mesh, int jobs);

// Simplifies a mesh to at most `target` vertices by edge collapses, shortest edges relative to
// `detail` first: [vertices] the target edge length at each vertex, in any unit. The result is a
// closed 2-manifold of the same topology, with more vertices if that allows no more collapses.
// `detail` is updated to the new vertices. A vertex may have at most 16 triangles; those of
// polygonise have at most 12.
//
// Not meshoptimizer: it follows the error of the surface, not `detail`, and version 0.18 left edges
// with more than two triangles where 2,500 vertices remain of a body's 40,000; the median quality
// of its triangles (4 sqrt(3) area over the sum of squared edges) was 0.62, here it is 0.97.
Mesh simplify(const Mesh& mesh, std::vector<double>& detail, std::size_t target);

// Tangential relaxation: flips edges towards valence six, moves vertices within the surface towards
// the mean of their neighbours and projects them back onto it. `strength` in [0, 1].
void relax(Mesh& mesh, const BlockedField& field, int passes, double strength, int jobs);

// Unit vertex normals: triangle normals weighted by the sine of the angle at the vertex.
std::vector<Vec3> vertex_normals(const Mesh& mesh);

// Enclosed volume, positive if the triangles face outwards.
double signed_volume(const Mesh& mesh);

// The neighbours of each vertex, in increasing order.
std::vector<std::vector<std::uint32_t>> vertex_neighbours(const Mesh& mesh);

}  // namespace krok::body
