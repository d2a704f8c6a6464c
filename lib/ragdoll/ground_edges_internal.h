#pragma once

#include <array>
#include <span>
#include <vector>

#include "math/transform.h"
#include "ragdoll/bodies.h"

// The convex edges of a ground of triangles, and where bodies touch them.

namespace krok::ragdoll {

struct GroundEdge {
  Vec3 begin, along;  // metres; `along` is a unit vector
  double length = 0;
  Vec3 first, second;  // unit normals of its sides, out of the ground
};

struct EdgeTouch {
  double gap = 0;
  Vec3 normal, on_body;  // world; out of the ground
};

class GroundEdges {
 public:
  // From triangles that are solid below; walls may face either side. Collinear pieces count as one
  // edge, however finely the triangles are split. Walls have no edges between them.
  explicit GroundEdges(std::span<const std::array<Vec3, 3>> triangles);

  // Numbers of the edges that a triangle has.
  std::span<const int> of_triangle(int triangle) const {
    return of_[static_cast<std::size_t>(triangle)];
  }
  // Out of the ground, of a wall that meets the ground at its top or foot; 0 for other triangles.
  const Vec3& wall_side(int triangle) const {
    return wall_sides_[static_cast<std::size_t>(triangle)];
  }
  const GroundEdge& operator[](int edge) const { return edges_[static_cast<std::size_t>(edge)]; }
  std::size_t count() const { return edges_.size(); }

 private:
  std::vector<GroundEdge> edges_;
  std::vector<std::vector<int>> of_;
  std::vector<Vec3> wall_sides_;  // shape [triangles]
};

// At most three places where a shape at `pose` touches an edge or is within `reach` of it; only of
// the edge itself, not of a face beside it.
void touch_edge(const Shape& shape, const Transform& pose, const GroundEdge& edge, double reach,
                std::vector<EdgeTouch>& touches);

}  // namespace krok::ragdoll
