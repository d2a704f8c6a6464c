#include "compare/surface_match_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "compare/measure.h"
#include "compare/mesh_difference.h"
#include "compare/surface_fit_internal.h"
#include "core/numbers.h"
#include "core/parallel.h"

namespace krok::compare {

namespace {

constexpr std::size_t kFewProbes = 5,
                      kManyProbes = 16;  // times used to choose between touching surfaces
constexpr std::size_t kProbedVertices = 2'000'000;  // over all of them, which bounds memory
constexpr std::size_t kMoreProbes = 11;             // those of the animations
constexpr std::size_t kMaxTried = 1024;             // touching points, to bound the run time
constexpr double kNoShare = 1e-9;                   // smaller coordinates are rounding errors
constexpr std::size_t kSampled = 1024;              // vertices, for the median distance
constexpr double kOfMedian = 4;     // distances at which a point is as good as the nearest
constexpr double kMaxNear = 1e-3;   // of the size, the same
constexpr double kWider = 4;        // times that far, where the right one is not found
constexpr std::size_t kFewOf = 50;  // one vertex of that many may lie at a sharp edge

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

bool finite(const SceneState& state) {
  return std::all_of(state.positions.begin(), state.positions.end(), [](const Points& points) {
    return std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
  });
}

// The first of the moments, some spread over all, and the middle one of each animation: surfaces
// that touch in one may part in another.
std::vector<std::size_t> probes_of(const std::vector<Moment>& moments, std::size_t vertices) {
  std::vector<std::size_t> probes;
  const std::size_t spread = std::min(
      moments.size(),
      std::clamp(kProbedVertices / std::max<std::size_t>(vertices, 1), kFewProbes, kManyProbes));
  for (std::size_t i = 0; i < spread; ++i) {
    probes.push_back(spread == 1 ? 0 : i * (moments.size() - 1) / (spread - 1));
  }
  for (std::size_t begin = 0, end = 0; begin < moments.size(); begin = end) {
    while (end < moments.size() && moments[end].first_animation == moments[begin].first_animation) {
      ++end;
    }
    if (probes.size() < spread + kMoreProbes) probes.push_back((begin + end) / 2);
  }
  std::ranges::sort(probes);
  probes.erase(std::unique(probes.begin(), probes.end()), probes.end());
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

// How far a point may be to be as good as the nearest, and to be tried at all: the right one may be
// farther, where a mesh is quantised and its edges are hard, or where other surfaces touch.
struct Reach {
  double near = 0, tried = 0;
};

Reach reach_of(const SurfaceMoments& own, const std::vector<int>& meshes, const FacetTree& tree,
               double tolerance) {
  std::vector<double> distances;
  std::vector<FoundFacet> found;
  const std::size_t step = 1 + vertices_of(own.meshes, meshes) / kSampled;
  for (const int mesh : meshes) {
    const Points& vertices = own.states[0].positions[static_cast<std::size_t>(mesh)];
    for (std::size_t v = 0; v < vertices.size(); v += step) {
      tree.find(vertices[v], found);
      double nearest = std::numeric_limits<double>::infinity();
      for (const FoundFacet& one : found) nearest = std::min(nearest, one.distance);
      distances.push_back(nearest);
    }
  }
  if (distances.empty()) return {};
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double most = kMaxNear * tree.size();
  const double near = std::min(std::max(kOfMedian * *middle, tolerance), most);
  const double largest = *std::max_element(distances.begin(), distances.end());
  return {near, std::min(std::max(near, largest), most)};
}

// 1 for the vertices that show: those of triangles, or of a cloud of points all.
std::vector<char> shown_vertices(const SceneMesh& mesh) {
  std::vector<char> shown(mesh.vertex_count, mesh.triangles.empty() ? 1 : 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) shown[corner] = 1;
  }
  return shown;
}

// For each vertex of a mesh that shows, the nearest point of the other surface.
SurfaceMatch match_surface(const Surfaces& surfaces, int mesh, int jobs) {
  const FacetTree& tree = surfaces.tree;
  const Points& vertices = surfaces.own.states[0].positions[static_cast<std::size_t>(mesh)];
  SurfaceMatch match;
  match.mesh = mesh;
  match.points.resize(vertices.size());
  match.fits.resize(vertices.size());
  const std::vector<char> shown =
      shown_vertices(surfaces.own.meshes[static_cast<std::size_t>(mesh)]);
  // Coincident vertices, as at seams or in a collapsed prop, share a search.
  const std::vector<std::uint32_t> order = by_place(vertices);
  parallel_for(order.size(), 1024, jobs, [&](std::size_t begin, std::size_t end) {
    std::vector<FoundFacet> found;
    std::vector<SurfacePoint> points;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t v = order[i];
      if (shown[v] == 0) continue;
      if (points.empty() || vertices[v] != vertices[order[i - 1]]) {
        tree.find(vertices[v], found, surfaces.tried);
        points = distinct_points(tree, vertices[v], found);
      }
      ChosenPoints chosen = choose(points, surfaces, mesh, v);
      // One that stays nearer is at most that far away at the first moment, too.
      const double wider = std::min({chosen.other_part ? tree.size() : chosen.distance,
                                     kWider * surfaces.tried, kWider * kMaxNear * tree.size()});
      if (wider > surfaces.tried) {
        std::vector<FoundFacet> more;
        tree.find(vertices[v], more, wider);
        chosen = choose(distinct_points(tree, vertices[v], more), surfaces, mesh, v);
      }
      match.points[v] = chosen.nearest;
      match.fits[v] = chosen.fits;
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
        std::count_if(match.fits.begin(), match.fits.end(), [&](const SurfacePoint& point) {
          return point.mesh < 0 || other[static_cast<std::size_t>(point.mesh)].has_tangents;
        });
    const auto all = static_cast<std::ptrdiff_t>(match.fits.size());
    if (!mesh.has_tangents || with == 0 || with == all) continue;
    comparison.note(fmt::format(
        "{}{}: {} of its {} nearest points have no tangents, so its tangents are not compared",
        match.in_second ? "the second's " : "", label("mesh", mesh.name, match.mesh), all - with,
        all));
  }
}

// Reports attributes that a mesh has and the surface next to it has not; further texture
// coordinates count if a texture `uses_more`. The other way round comes with the other direction.
void report_missing_on(SceneComparison& comparison, const SceneMesh& mesh, const SceneMesh& other,
                       bool in_second, bool uses_more, const std::string& name) {
  if (mesh.only_points || other.only_points) return;
  const auto report = [&](bool has, bool other_has, const char* what, bool counts) {
    if (!has || other_has) return;
    std::string text =
        fmt::format("{}: only the {} has {}", name, in_second ? "second" : "first", what);
    auto& texts = counts ? comparison.result.structure : comparison.result.notes;
    if (std::ranges::find(texts, text) == texts.end()) texts.push_back(std::move(text));
  };
  report(mesh.has_normals, other.has_normals, "normals", true);
  report(!mesh.texture_coordinates.empty(), !other.texture_coordinates.empty(),
         "texture coordinates", true);
  report(mesh.is_painted(), !other.colours.empty(), "vertex colours", comparison.options.materials);
  const auto sets_of = [](const SceneMesh& one) {
    return std::ranges::count_if(one.more_texture_coordinates,
                                 [](const auto& set) { return !set.empty(); });
  };
  report(sets_of(mesh) > sets_of(other), false, "further texture coordinates", uses_more);
}

// The static data of a mesh at its nearest points: texture coordinates, colours, sides, materials.
void compare_surface(SceneComparison& comparison, const Surfaces& surfaces,
                     const SurfaceMatch& match) {
  const SceneMesh& mesh = surfaces.own.meshes[static_cast<std::size_t>(match.mesh)];
  const std::string name =
      (match.in_second ? "the second's " : "") + label("mesh", mesh.name, match.mesh);
  ValueLocation place{.mesh = match.mesh, .in_second = match.in_second};
  std::map<int, std::size_t> on_mesh;  // vertices by mesh of the other
  std::size_t behind = 0;
  for (std::size_t v = 0; v < match.points.size(); ++v) {
    const SurfacePoint& point = match.fits[v];
    if (point.mesh < 0) continue;
    const SceneMesh& other = mesh_of(point, surfaces.other);
    place.vertex = static_cast<int>(v);
    ++on_mesh[point.mesh];
    if (lies_behind(point, surfaces.own, static_cast<std::size_t>(match.mesh), v, surfaces.other)) {
      ++behind;
    }
    const auto add = [&](const auto& ours, const auto& theirs, Measure& measure) {
      if (ours.empty() || theirs.empty()) return;
      const auto apart = (ours[v] - value_in(point, theirs)).cwiseAbs().maxCoeff();
      measure.add(static_cast<double>(apart), place);
    };
    add(mesh.texture_coordinates, other.texture_coordinates, comparison.result.texture_coordinates);
    add(mesh.colours, other.colours, comparison.result.colours);
    const auto &sets = mesh.more_texture_coordinates, &others = other.more_texture_coordinates;
    for (std::size_t set = 0; set < std::min(sets.size(), others.size()); ++set) {
      add(sets[set], others[set], comparison.result.texture_coordinates);
    }
  }
  const std::size_t few = match.points.size() / kFewOf;
  if (behind > few) {
    comparison.say(
        fmt::format("{}: {} of its {} vertices are inside out: they lie on the backs of "
                    "the other's triangles",
                    name, behind, match.points.size()));
  }
  const UsedTextures& textures =
      match.in_second ? comparison.second_textures : comparison.first_textures;
  bool uses_more = comparison.options.materials;
  for (std::size_t set = 1; set <= mesh.more_texture_coordinates.size(); ++set) {
    uses_more = uses_more || textures.uses(match.mesh, set);
  }
  for (const auto& [index, count] : on_mesh) {
    const SceneMesh& other = surfaces.other.meshes[static_cast<std::size_t>(index)];
    if (count <= few) continue;
    report_missing_on(comparison, mesh, other, match.in_second, uses_more, name);
    compare_materials(comparison, match.in_second ? other : mesh, match.in_second ? mesh : other,
                      name);
    if (other.visible == mesh.visible) continue;
    comparison.say(fmt::format("{}: hidden in the {}", name,
                               mesh.visible != match.in_second ? "second" : "first"));
  }
}

// Matches the meshes of a group of one scene with the other's, whose facets are in the tree.
void match_group(SceneComparison& comparison, const std::vector<int>& meshes,
                 const std::vector<int>& others, bool in_second, Surfaces surfaces, int jobs) {
  const Reach reach =
      reach_of(surfaces.own, meshes, surfaces.tree, comparison.options.tolerance.length);
  surfaces.near = reach.near;
  surfaces.tried = reach.tried;
  surfaces.same_materials = same_materials(comparison, surfaces.own, surfaces.other);
  surfaces.own_joints = in_second ? std::vector<int>(comparison.first.joint_names.size(), -1)
                                  : comparison.first_joint_of_second;
  for (const auto& [first, second] : comparison.joints) {
    if (in_second) surfaces.own_joints[static_cast<std::size_t>(first)] = second;
  }
  std::vector<SurfaceMatch> matches;
  for (const int mesh : meshes) {
    SurfaceMatch match = match_surface(surfaces, mesh, jobs);
    match.in_second = in_second;
    compare_surface(comparison, surfaces, match);
    matches.push_back(std::move(match));
  }
  find_holes(comparison, matches, surfaces, others, jobs);
  std::ranges::move(matches, std::back_inserter(comparison.surfaces));
}

}  // namespace

Status match_surfaces(SceneComparison& comparison, int jobs) {
  if (comparison.groups.empty()) return {};
  comparison.result.at_least = true;
  std::vector<SceneState> first, second;
  std::size_t vertices = 0;
  for (const SceneMesh& mesh : comparison.first.meshes) vertices += mesh.vertex_count;
  for (const std::size_t probe : probes_of(comparison.moments, vertices)) {
    const Moment& moment = comparison.moments[probe];
    comparison.first.evaluate(moment.first_animation, moment.first_time, first.emplace_back());
    comparison.second.evaluate(moment.second_animation, moment.second_time, second.emplace_back());
  }
  if (!finite(first.front()) || !finite(second.front())) {
    return Error("compare-value", "a scene has positions that are NaN or infinite",
                 "its nodes or keys have values that are too large");
  }
  SurfaceMoments a{comparison.first.meshes, first};
  SurfaceMoments b{comparison.second.meshes, second};
  a.faces = all_faces(a);
  b.faces = all_faces(b);
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
    match_group(comparison, group.first, group.second, false, {a, b, *second_tree}, jobs);
    match_group(comparison, group.second, group.first, true, {b, a, *first_tree}, jobs);
    compare_areas(comparison, group, a, b);
  }
  report_tangents_left_out(comparison);
  return {};
}

}  // namespace krok::compare
