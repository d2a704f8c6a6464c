#pragma once

#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <array>
#include <span>
#include <vector>

#include "ragdoll/ground_edges_internal.h"

// The faces of a ground of triangles, and where bodies touch them.

namespace krok::ragdoll {

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
