#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "body/lattice.h"

// From the implicit surface to triangles.

namespace krok::body {

// Twice the area of a triangle, along its normal.
inline Vec3 area_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a);
}

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
};

// Marching tetrahedra (Doi and Koide 1991) over the cubes of the lattice, each cut into the six
// tetrahedra around its main diagonal (Kuhn's subdivision), which fit together from cube to cube:
// the result is a closed 2-manifold whatever the values. Vertices come in a fixed order.
Mesh polygonise(const Lattice& lattice, int jobs);

// Whether a closed 2-manifold is one piece without handles.
bool is_sphere(const Mesh& mesh);

// Moves every vertex half-way to the middle of its neighbours.
void smooth(Mesh& mesh, int jobs);

// A mesh of at most `target` vertices made from a finer one by collapsing edges, the shortest for
// their place first: `detail` [vertices] is the edge length wanted at each vertex, in any unit. The
// result is a closed 2-manifold of the same topology; where that forbids more collapses it has more
// vertices. `detail` is brought in line. No vertex may have more than 16 triangles; those of
// polygonise have at most 12.
Mesh simplify(const Mesh& mesh, std::vector<double>& detail, std::size_t target);

// Evens out the triangles: flips edges towards six around each vertex, moves vertices within the
// surface towards the middle of their neighbours and back onto the surface. `strength` in [0, 1].
void relax(Mesh& mesh, const BlockedField& field, int passes, double strength, int jobs);

// Vertex normals, unit: those of the triangles around each vertex, weighted by the sine of their
// angle there.
std::vector<Vec3> vertex_normals(const Mesh& mesh);

// Volume enclosed, positive where the triangles face outwards.
double signed_volume(const Mesh& mesh);

// For each vertex its neighbours, in rising order.
std::vector<std::vector<std::uint32_t>> vertex_neighbours(const Mesh& mesh);

}  // namespace krok::body
