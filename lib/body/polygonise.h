#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "body/implicit.h"

// From the implicit surface to triangles.

namespace krok::body {

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
};

// A field with the tubes that matter looked up block by block of space.
class BlockedField {
 public:
  // Blocks of kCells lattice cells of size `cell`, those that the surface may pass through.
  static constexpr int kCells = 8;
  BlockedField(const Field& field, double cell, int jobs);

  double value(const Vec3& point) const { return field_.value(point, near(point)); }
  Vec3 gradient(const Vec3& point) const {
    return field_.gradient(point, near(point), 0.25 * cell_);
  }
  std::vector<TubePlace> places(const Vec3& point) const {
    return field_.places(point, near(point));
  }
  // Moves a point near the surface onto it, by at most `limit`.
  Vec3 onto_surface(const Vec3& point, double limit) const;

  struct Block {
    std::array<std::int64_t, 3> corner;  // lattice coordinates of its lowest corner
    Field::Near near;
  };
  const std::vector<Block>& blocks() const { return blocks_; }
  Vec3 lattice_point(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return origin_ +
           cell_ * Vec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  }
  const Field& field() const { return field_; }
  double cell() const { return cell_; }

 private:
  const Field::Near& near(const Vec3& point) const;

  const Field& field_;
  double cell_;
  Vec3 origin_;
  std::vector<Block> blocks_;
  std::unordered_map<std::uint64_t, std::size_t> index_;
  Field::Near everything_;
};

// Marching tetrahedra (Doi and Koide 1991) over the cubes of the lattice, each cut into the six
// tetrahedra around its main diagonal (Kuhn's subdivision), which fit together from cube to cube:
// the result is a closed 2-manifold whatever the field. Vertices come in a fixed order.
Mesh polygonise(const BlockedField& field, int jobs);

// The connected pieces of a mesh but those with under `share` of the vertices.
Mesh without_fragments(const Mesh& mesh, double share);

// Moves every vertex half-way to the middle of its neighbours.
void smooth(Mesh& mesh, int jobs);

// A mesh of at most `target` vertices made from a finer one by collapsing edges, the shortest for
// their place first: `detail` [vertices] is the edge length wanted at each vertex, in any unit. The
// result is a closed 2-manifold of the same topology; where that forbids more collapses it has more
// vertices. `detail` is brought in line.
Mesh simplify(const Mesh& mesh, std::vector<double>& detail, std::size_t target);

// Evens out the triangles: flips edges towards six around each vertex, moves vertices within the
// surface towards the middle of their neighbours and back onto the surface. `strength` in [0, 1].
void relax(Mesh& mesh, const BlockedField& field, int passes, double strength, int jobs);

// Area- and angle-weighted vertex normals, unit.
std::vector<Vec3> vertex_normals(const Mesh& mesh);

// Volume enclosed, positive where the triangles face outwards.
double signed_volume(const Mesh& mesh);

// For each vertex its neighbours, in rising order.
std::vector<std::vector<std::uint32_t>> vertex_neighbours(const Mesh& mesh);

}  // namespace krok::body
