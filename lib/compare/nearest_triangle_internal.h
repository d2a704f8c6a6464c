#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "math/transform.h"

// Private to this folder: finds the triangles nearest to a point.

namespace krok::compare {

// A triangle, or an edge or a point if corners coincide.
struct Facet {
  int mesh = -1;
  std::array<std::uint32_t, 3> corners{};
  std::array<Vec3, 3> points;
};

// Barycentric coordinates of the nearest point of a triangle, each in [0, 1], summing to 1. Source:
// Ericson, Real-Time Collision Detection (2005), section 5.1.5.
std::array<double, 3> nearest_shares(const std::array<Vec3, 3>& triangle, const Vec3& point);

struct FoundFacet {
  std::uint32_t facet = 0;
  std::array<double, 3> shares{};
  double distance = 0;
};

// A BVH (Embree) over at least one facet; points must be finite. Const functions are thread-safe.
class FacetTree {
 public:
  // Null if Embree is not available.
  static std::unique_ptr<const FacetTree> create(std::vector<Facet> facets);
  ~FacetTree();
  FacetTree(const FacetTree&) = delete;
  FacetTree& operator=(const FacetTree&) = delete;

  const Facet& facet(std::uint32_t index) const { return facets_[index]; }

  // Max distance between surfaces that count as touching: a millionth of the size of the bounding
  // box.
  double touching() const { return touching_; }

  double size() const { return size_; }  // of the bounding box of all facets

  // Fills `found` with the facet nearest to `point` and all facets at most touching() farther away,
  // or at most `near` away, sorted by index.
  void find(const Vec3& point, std::vector<FoundFacet>& found, double near = 0) const;

 private:
  struct Embree;
  explicit FacetTree(std::vector<Facet> facets);
  bool build();

  std::vector<Facet> facets_;
  Vec3 centre_ = Vec3::Zero();  // origin of the tree's floats
  double size_ = 0;             // of the bounding box of all facets
  double touching_ = 0;
  std::unique_ptr<Embree> embree_;
};

}  // namespace krok::compare
