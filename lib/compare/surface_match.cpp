#include "compare/surface_match_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "compare/measure.h"
#include "compare/mesh_difference.h"
#include "compare/nearest_triangle_internal.h"
#include "compare/scene_comparison_internal.h"
#include "core/parallel.h"

namespace krok::compare {

namespace {

constexpr std::size_t kMaxProbes = 5;    // times used to choose between touching surfaces
constexpr std::size_t kMaxTried = 1024;  // touching points, to bound the run time
constexpr double kNoShare = 1e-9;        // smaller coordinates are rounding errors
constexpr double kSameAngle = 1e-4;      // radians; smaller angles between normals are float noise

std::vector<Facet> facets_of(const SurfaceMoments& scene, std::span<const int> meshes) {
  std::vector<Facet> facets;
  for (const int index : meshes) {
    const SceneMesh& mesh = scene.meshes[static_cast<std::size_t>(index)];
    const Points& points = scene.states[0].positions[static_cast<std::size_t>(index)];
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      facets.push_back({index, {a, b, c}, {points[a], points[b], points[c]}});
    };
    for (const Triangle& t : mesh.triangles) add(t[0], t[1], t[2]);
    if (!mesh.triangles.empty()) continue;
    for (std::uint32_t v = 0; v < points.size(); ++v) add(v, v, v);
  }
  return facets;
}

// The same point for all triangles that share it: corners with coordinate 0 are replaced by the
// largest one, then corners are sorted by index.
SurfacePoint point_on(const Facet& facet, const std::array<double, 3>& shares) {
  std::array<std::pair<std::uint32_t, double>, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = {facet.corners[k], shares[k] < kNoShare ? 0.0 : shares[k]};
  }
  const auto largest =
      *std::max_element(corners.begin(), corners.end(),
                        [](const auto& a, const auto& b) { return a.second < b.second; });
  for (auto& corner : corners) {
    if (corner.second == 0) corner.first = largest.first;
  }
  std::sort(corners.begin(), corners.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  });
  SurfacePoint point;
  point.mesh = facet.mesh;
  for (std::size_t k = 0; k < 3; ++k) {
    point.corners[k] = corners[k].first;
    point.shares[k] = corners[k].second;
  }
  return point;
}

bool same_corners(const SurfacePoint& a, const SurfacePoint& b) {
  return a.mesh == b.mesh && a.corners == b.corners;
}

// How well a point fits a vertex over the probed moments.
struct Fit {
  double distance = 0;  // the largest
  double angle = 0;     // max, of normals; 0 if one has none
  double tangents = 0;  // max, see tangents_apart(); 0 if both have none
};

// Angle between tangents at one moment, plus pi for opposite handedness; pi if only one mesh has
// tangents, so that coincident meshes with and without tangents are not confused.
double tangents_apart(const SurfacePoint& point, const SurfaceMoments& own, std::size_t mesh,
                      std::size_t vertex, const SurfaceMoments& other, std::size_t moment) {
  const bool has = own.meshes[mesh].has_tangents;
  if (has != other.meshes[static_cast<std::size_t>(point.mesh)].has_tangents) return kPi;
  if (!has) return 0;
  const Vec4& a = own.states[moment].tangents[mesh][vertex];
  const Vec4 b = value_at(point, other.states[moment].tangents);
  return angle_between_directions(a.head<3>(), b.head<3>()) + (on_other_sides(a, b) ? kPi : 0);
}

Fit fit_of(const SurfacePoint& point, const SurfaceMoments& own, int mesh, std::size_t vertex,
           const SurfaceMoments& other) {
  Fit fit;
  const auto m = static_cast<std::size_t>(mesh);
  for (std::size_t k = 0; k < own.states.size(); ++k) {
    const SceneState& a = own.states[k];
    const SceneState& b = other.states[k];
    fit.distance =
        std::max(fit.distance, (a.positions[m][vertex] - value_at(point, b.positions)).norm());
    fit.tangents = std::max(fit.tangents, tangents_apart(point, own, m, vertex, other, k));
    if (a.normals[m].empty() || b.normals[static_cast<std::size_t>(point.mesh)].empty()) continue;
    fit.angle = std::max(
        fit.angle, angle_between_directions(a.normals[m][vertex], value_at(point, b.normals)));
  }
  return fit;
}

SurfacePoint choose(const std::vector<SurfacePoint>& points, const SurfaceMoments& own, int mesh,
                    std::size_t vertex, const SurfaceMoments& other, double touching) {
  if (points.size() == 1) return points.front();
  std::vector<Fit> fits;
  double least = std::numeric_limits<double>::infinity();
  for (const SurfacePoint& point : points) {
    fits.push_back(fit_of(point, own, mesh, vertex, other));
    least = std::min(least, fits.back().distance);
  }
  // Keeps the closest points, of those the ones with matching normals; tangents decide at texture
  // seams, where vertices are otherwise the same.
  double least_angle = std::numeric_limits<double>::infinity();
  for (const Fit& fit : fits) {
    if (fit.distance <= least + touching) least_angle = std::min(least_angle, fit.angle);
  }
  std::size_t best = points.size();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Fit& fit = fits[i];
    if (fit.distance > least + touching || fit.angle > least_angle + kSameAngle) continue;
    if (best == points.size() ||
        std::tie(fit.tangents, fit.angle) < std::tie(fits[best].tangents, fits[best].angle)) {
      best = i;
    }
  }
  return points[best];
}

bool finite(const SceneState& state) {
  return std::all_of(state.positions.begin(), state.positions.end(), [](const Points& points) {
    return std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
  });
}

std::vector<std::size_t> probes_of(std::size_t moments) {
  std::vector<std::size_t> probes;
  const std::size_t count = std::min(moments, kMaxProbes);
  for (std::size_t i = 0; i < count; ++i) {
    probes.push_back(count == 1 ? 0 : i * (moments - 1) / (count - 1));
  }
  return probes;
}

std::size_t vertices_of(const std::vector<SceneMesh>& meshes, const std::vector<int>& chosen) {
  std::size_t count = 0;
  for (const int mesh : chosen) count += meshes[static_cast<std::size_t>(mesh)].vertex_count;
  return count;
}

// Distinct candidate points for `place`, including corners at the same distance (all corners of
// degenerate triangles).
std::vector<SurfacePoint> distinct_points(const FacetTree& tree, const Vec3& place,
                                          const std::vector<FoundFacet>& found) {
  std::vector<SurfacePoint> points;
  points.reserve(found.size());
  for (const FoundFacet& one : found) {
    const Facet& facet = tree.facet(one.facet);
    points.push_back(point_on(facet, one.shares));
    for (std::size_t k = 0; k < 3; ++k) {
      if ((facet.points[k] - place).norm() > one.distance + tree.touching()) continue;
      std::array<double, 3> corner{};
      corner[k] = 1;
      points.push_back(point_on(facet, corner));
    }
  }
  std::stable_sort(points.begin(), points.end(), [](const SurfacePoint& a, const SurfacePoint& b) {
    return std::tie(a.mesh, a.corners) < std::tie(b.mesh, b.corners);
  });
  points.erase(std::unique(points.begin(), points.end(), same_corners), points.end());
  points.resize(std::min(points.size(), kMaxTried));
  return points;
}

// Vertex indices sorted by position, so that coincident vertices are adjacent.
std::vector<std::uint32_t> by_place(const Points& vertices) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const Vec3& a = vertices[i];
    const Vec3& b = vertices[j];
    return std::tie(a.x(), a.y(), a.z(), i) < std::tie(b.x(), b.y(), b.z(), j);
  });
  return order;
}

// For each vertex of a mesh of `own`, the nearest point of `other`, whose facets are in the tree.
SurfaceMatch match_surface(const SurfaceMoments& own, int mesh, const SurfaceMoments& other,
                           const FacetTree& tree, int jobs) {
  const Points& vertices = own.states[0].positions[static_cast<std::size_t>(mesh)];
  SurfaceMatch match;
  match.mesh = mesh;
  match.points.resize(vertices.size());
  // Coincident vertices, as at seams or in a collapsed prop, share a search.
  const std::vector<std::uint32_t> order = by_place(vertices);
  parallel_for(order.size(), 1024, jobs, [&](std::size_t begin, std::size_t end) {
    std::vector<FoundFacet> found;
    std::vector<SurfacePoint> points;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t v = order[i];
      if (i == begin || vertices[v] != vertices[order[i - 1]]) {
        tree.find(vertices[v], found);
        points = distinct_points(tree, vertices[v], found);
      }
      match.points[v] = choose(points, own, mesh, v, other, tree.touching());
    }
  });
  return match;
}

// A mesh is compared in the attributes that all of its nearest points have.
void report_tangents_left_out(SceneComparison& comparison) {
  for (const SurfaceMatch& match : comparison.surfaces) {
    const auto& own = match.in_second ? comparison.second.meshes : comparison.first.meshes;
    const auto& other = match.in_second ? comparison.first.meshes : comparison.second.meshes;
    const SceneMesh& mesh = own[static_cast<std::size_t>(match.mesh)];
    const auto with =
        std::count_if(match.points.begin(), match.points.end(), [&](const SurfacePoint& point) {
          return other[static_cast<std::size_t>(point.mesh)].has_tangents;
        });
    const auto all = static_cast<std::ptrdiff_t>(match.points.size());
    if (!mesh.has_tangents || with == 0 || with == all) continue;
    comparison.note(fmt::format(
        "{}{}: {} of its {} nearest points have no tangents, so its tangents are not compared",
        match.in_second ? "the second's " : "", label("mesh", mesh.name, match.mesh), all - with,
        all));
  }
}

}  // namespace

Status match_surfaces(SceneComparison& comparison, int jobs) {
  if (comparison.groups.empty()) return {};
  std::vector<SceneState> first, second;
  for (const std::size_t probe : probes_of(comparison.moments.size())) {
    const Moment& moment = comparison.moments[probe];
    comparison.first.evaluate(moment.first_animation, moment.first_time, first.emplace_back());
    comparison.second.evaluate(moment.second_animation, moment.second_time, second.emplace_back());
  }
  if (!finite(first.front()) || !finite(second.front())) {
    return Error("compare-value", "a scene has positions that are NaN or infinite",
                 "its nodes or keys have values that are too large");
  }
  const SurfaceMoments a{comparison.first.meshes, first};
  const SurfaceMoments b{comparison.second.meshes, second};
  for (const SurfaceGroup& group : comparison.groups) {
    const std::size_t first_vertices = vertices_of(a.meshes, group.first);
    const std::size_t second_vertices = vertices_of(b.meshes, group.second);
    if (first_vertices == 0 || second_vertices == 0) {
      if (first_vertices == second_vertices) continue;
      const int mesh = group.first.front();
      comparison.say(fmt::format("{}: only the {} has vertices",
                                 label("mesh", a.meshes[static_cast<std::size_t>(mesh)].name, mesh),
                                 first_vertices == 0 ? "second" : "first"));
      continue;
    }
    const auto first_tree = FacetTree::create(facets_of(a, group.first));
    const auto second_tree = FacetTree::create(facets_of(b, group.second));
    if (!first_tree || !second_tree) {
      return Error("compare-search", "Embree is not available on this machine");
    }
    for (const int mesh : group.first) {
      comparison.surfaces.push_back(match_surface(a, mesh, b, *second_tree, jobs));
    }
    for (const int mesh : group.second) {
      comparison.surfaces.push_back(match_surface(b, mesh, a, *first_tree, jobs));
      comparison.surfaces.back().in_second = true;
    }
  }
  report_tangents_left_out(comparison);
  return {};
}

}  // namespace krok::compare
