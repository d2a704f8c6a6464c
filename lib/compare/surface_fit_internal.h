#pragma once

#include <vector>

#include "compare/nearest_triangle_internal.h"
#include "compare/scene_comparison_internal.h"
#include "compare/surface_match_internal.h"

// Private to this folder: which of several near points of a surface fits a vertex.

namespace krok::compare {

using SameMaterials = std::vector<std::vector<bool>>;  // [meshes][meshes of the other]

// The two surfaces, and what is known of them.
struct Surfaces {
  const SurfaceMoments& own;
  const SurfaceMoments& other;
  const FacetTree& tree;  // of `other`
  double near = 0;        // a point at most this far away is as good as the nearest
  double tried = 0;       // points at most this far away are tried
  SameMaterials same_materials{};
  std::vector<int> own_joints{};  // [joints of `other`] of `own`, -1 for none
};

// Fills SurfaceMoments::faces of a scene.
std::vector<Points> all_faces(const SurfaceMoments& scene);

SameMaterials same_materials(const SceneComparison& comparison, const SurfaceMoments& own,
                             const SurfaceMoments& other);

// Whether a point is on a front face where the vertex is on a back face. Where the sides are not
// clear, as at a sharp edge, it is not.
bool lies_behind(const SurfacePoint& point, const SurfaceMoments& own, std::size_t mesh,
                 std::size_t vertex, const SurfaceMoments& other);

// Reports triangles whose corners lie on the other surface, which is of the meshes `others`, and
// whose insides or edges do not: holes. A cloud of points has no insides. (surface_insides.cpp)
void find_holes(SceneComparison& comparison, const std::vector<SurfaceMatch>& matches,
                const Surfaces& surfaces, const std::vector<int>& others, int jobs);

// Reports other areas, by material where both scenes name the same, and other numbers of triangles.
void compare_areas(SceneComparison& comparison, const SurfaceGroup& group,
                   const SurfaceMoments& first, const SurfaceMoments& second);

struct ChosenPoints {
  SurfacePoint nearest;     // that stays nearest
  SurfacePoint fits;        // whose attributes fit best of those about as near
  double distance = 0;      // of the nearest, the largest over all moments
  bool other_part = false;  // it hangs on other joints than the vertex
};
// Points on other joints are left out where there are others.
ChosenPoints choose(std::vector<SurfacePoint> points, const Surfaces& surfaces, int mesh,
                    std::size_t vertex);

}  // namespace krok::compare
