#pragma once

#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
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

// The faces of a ground of triangles, and where bodies touch them.

inline constexpr double kThick = 0.03;  // metres: what is deeper below a face is on its other side
inline constexpr std::size_t kTouches = 2;  // of a feeler, as in the corner below a step
inline constexpr double kSameWay = 0.98;    // cosine between normals of one contact

// Faces of the ground near a body.
class Faces final : public btTriangleCallback {
 public:
  struct Face {
    Vec3 normal;
    std::array<Vec3, 3> corners, inward;
    bool wall = false;  // whose free side is not known

    bool is_beside(const Vec3& point) const {
      for (std::size_t k = 0; k < 3; ++k) {
        if (inward[k].dot(point - corners[k]) < 0) return false;
      }
      return true;
    }
  };

  explicit Faces(const GroundEdges& edges) : edges_(edges) {}

  const std::vector<Face>& faces() const { return faces_; }
  const std::vector<int>& numbers() const { return numbers_; }  // of triangles
  void clear() {
    faces_.clear();
    numbers_.clear();
  }

  void processTriangle(btVector3* corners, int part, int number) override;

 private:
  const GroundEdges& edges_;
  std::vector<Face> faces_;
  std::vector<int> numbers_;
};

struct Touch {
  double gap = 0;
  Vec3 normal, on_body;
};

// Where a ball of `radius` about `point` touches faces, the shallowest first, at most two. `free`
// is on the free side of walls. What is behind a shallower face and no more behind a deeper one
// when it has come out of the first, as at the edge of a step, does not touch the deeper one.
void find_touches(const Vec3& point, double radius, const Vec3& free, double reach,
                  std::span<const Faces::Face> faces, std::vector<Touch>& touches);

}  // namespace krok::ragdoll
