#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "math/types.h"

// Private to this folder: the triangles that are nearest to a point.

namespace krok::compare {

// A triangle, or an edge or a point where corners are the same.
struct Facet {
  int mesh = -1;
  std::array<std::uint32_t, 3> corners{};
  std::array<Vec3, 3> points;
};

// The nearest point of a facet: the shares of its corners, each in [0, 1], together 1. Source:
// Ericson, Real-Time Collision Detection (2005), section 5.1.5.
std::array<double, 3> nearest_shares(const std::array<Vec3, 3>& triangle, const Vec3& point);

struct FoundFacet {
  std::uint32_t facet = 0;
  std::array<double, 3> shares{};
  double distance = 0;
};

// A search tree over facets, of which there is at least one; points are finite. Const functions may
// be called from many threads.
class FacetTree {
 public:
  // Null where Embree cannot be used.
  static std::unique_ptr<const FacetTree> create(std::vector<Facet> facets);
  ~FacetTree();
  FacetTree(const FacetTree&) = delete;
  FacetTree& operator=(const FacetTree&) = delete;

  const Facet& facet(std::uint32_t index) const { return facets_[index]; }

  // How far apart surfaces may be that count as touching: a millionth of the box around all.
  double touching() const { return touching_; }

  // Fills `found` with the facet that is nearest to `point` and all that are no more than
  // touching() farther, by their index.
  void find(const Vec3& point, std::vector<FoundFacet>& found) const;

 private:
  struct Embree;
  explicit FacetTree(std::vector<Facet> facets);
  bool build();

  std::vector<Facet> facets_;
  Vec3 centre_ = Vec3::Zero();  // of the tree's floats
  double size_ = 0;             // of the box around all
  double touching_ = 0;
  std::unique_ptr<Embree> embree_;
};

}  // namespace krok::compare
