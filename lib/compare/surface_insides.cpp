#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "compare/surface_fit_internal.h"
#include "core/numbers.h"
#include "core/parallel.h"

// What surfaces have between their vertices.

namespace krok::compare {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr std::size_t kSamples = 100'000;  // of a surface, for holes
constexpr int kMaxDivisions = 64;          // of a triangle's edge, the same
constexpr double kBackFace = -0.5;         // cosine of the angle to a face seen from behind
constexpr double kSameArea = 1e-3;         // of it: less is rounding

// The triangles of a material in a group of meshes, at the first time.
struct MaterialArea {
  long long triangles = 0;
  double area = 0;       // square metres
  double perimeter = 0;  // of all of them; half of it times a distance is area that moves
};

std::map<std::string, MaterialArea> areas_of(const SurfaceMoments& scene,
                                             const std::vector<int>& meshes, bool by_material) {
  std::map<std::string, MaterialArea> areas;
  for (const int index : meshes) {
    const auto m = static_cast<std::size_t>(index);
    const SceneMesh& mesh = scene.meshes[m];
    const Points& points = scene.states[0].positions[m];
    const bool named = by_material && mesh.material != nullptr;
    MaterialArea& one = areas[named ? mesh.material->name : std::string()];
    for (const Triangle& t : mesh.triangles) {
      const Vec3 ab = points[t[1]] - points[t[0]], ac = points[t[2]] - points[t[0]];
      const double area = 0.5 * ab.cross(ac).norm();
      if (!(area > 0)) continue;  // a flat one shows nothing
      ++one.triangles;
      one.area += area;
      one.perimeter += ab.norm() + ac.norm() + (ac - ab).norm();
    }
  }
  return areas;
}

}  // namespace

void find_holes(SceneComparison& comparison, const std::vector<SurfaceMatch>& matches,
                const Surfaces& surfaces, const std::vector<int>& others, int jobs) {
  const auto is_cloud = [&](int mesh) {
    return surfaces.other.meshes[static_cast<std::size_t>(mesh)].triangles.empty();
  };
  if (std::ranges::all_of(others, is_cloud)) return;
  double all_area = 0;
  struct Sampled {
    const SurfaceMatch* match = nullptr;
    Triangle corners{};
    double area = 0, gap = 0;
    bool turned = false;  // its back is where the other shows its front
  };
  const auto front_of = [](const SurfaceMoments& scene, int mesh, const std::array<Vec3, 3>& t) {
    return Vec3(winding_of(scene.states[0].windings, mesh) *
                (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized());
  };
  const auto cosine_to = [&](std::uint32_t index, const Vec3& normal) {
    const Facet& facet = surfaces.tree.facet(index);
    return front_of(surfaces.other, facet.mesh, facet.points).dot(normal);
  };
  std::vector<Sampled> triangles;
  for (const SurfaceMatch& match : matches) {
    const auto m = static_cast<std::size_t>(match.mesh);
    const Points& points = surfaces.own.states[0].positions[m];
    for (const Triangle& t : surfaces.own.meshes[m].triangles) {
      const double area =
          0.5 * (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm();
      triangles.push_back({&match, t, area});
      all_area += area;
    }
  }
  if (!(all_area > 0)) return;
  const double about = std::max(comparison.options.tolerance.length, surfaces.near);
  parallel_for(triangles.size(), 256, jobs, [&](std::size_t begin, std::size_t end) {
    std::vector<FoundFacet> found;
    for (std::size_t t = begin; t < end; ++t) {
      Sampled& one = triangles[t];
      const auto m = static_cast<std::size_t>(one.match->mesh);
      const Points& points = surfaces.own.states[0].positions[m];
      const auto& [a, b, c] = one.corners;
      const Vec3 normal =
          front_of(surfaces.own, one.match->mesh, {points[a], points[b], points[c]});
      // What the corners are off counts elsewhere.
      double allowed = about;
      for (const std::uint32_t corner : one.corners) {
        const Vec3 other = value_at(one.match->points[corner], surfaces.other.states[0].positions);
        allowed = std::max(allowed, about + (points[corner] - other).norm());
      }
      // The middles of parts of about the same size, and points of the edges.
      const int parts = std::clamp(
          static_cast<int>(std::ceil(std::sqrt(one.area / all_area * kSamples))), 1, kMaxDivisions);
      const auto sample = [&](double u, double v) {
        const Vec3 place = u * points[one.corners[0]] + v * points[one.corners[1]] +
                           (1 - u - v) * points[one.corners[2]];
        surfaces.tree.find(place, found);
        bool backs = true;
        double nearest = found.empty() ? 0 : found.front().distance;
        for (const FoundFacet& facet : found) {
          nearest = std::min(nearest, facet.distance);
          backs = backs && cosine_to(facet.facet, normal) < kBackFace;
        }
        if (nearest > allowed) one.gap = std::max(one.gap, nearest);
        if (!backs || one.turned || one.gap > 0) return;
        // Others that are about as near may face this way, as the sides of a sheet do.
        surfaces.tree.find(place, found, allowed);
        one.turned = std::ranges::all_of(found, [&](const FoundFacet& facet) {
          return cosine_to(facet.facet, normal) < kBackFace;
        });
      };
      for (int i = 0; i < parts; ++i) {
        const double along = (i + 0.5) / parts;  // on the edges
        sample(along, 1 - along);
        sample(along, 0);
        sample(0, along);
        for (int j = 0; i + j < parts; ++j) {
          sample((i + 1.0 / 3) / parts, (j + 1.0 / 3) / parts);
          if (i + j + 1 < parts) sample((i + 2.0 / 3) / parts, (j + 2.0 / 3) / parts);
        }
      }
    }
  });
  const auto report_turned = [&] {
    const auto turned = std::ranges::find_if(triangles, &Sampled::turned);
    if (turned != triangles.end()) {
      const auto m = static_cast<std::size_t>(turned->match->mesh);
      comparison.say(fmt::format("{}{}: {} wound the other way: the first at vertices {}, {}, {}",
                                 turned->match->in_second ? "the second's " : "",
                                 label("mesh", surfaces.own.meshes[m].name, turned->match->mesh),
                                 counted(std::ranges::count_if(triangles, &Sampled::turned),
                                         "triangle is", "triangles are"),
                                 turned->corners[0], turned->corners[1], turned->corners[2]));
    }
  };
  // Those with a gap are told as holes.
  for (Sampled& one : triangles) one.turned = one.turned && !(one.gap > 0);
  double missing = 0;
  std::size_t count = 0;
  const Sampled* worst = nullptr;
  for (const Sampled& one : triangles) {
    if (!(one.gap > 0)) continue;
    missing += one.area;
    ++count;
    if (worst == nullptr || one.gap > worst->gap) worst = &one;
  }
  if (worst == nullptr) return report_turned();
  const bool in_second = worst->match->in_second;
  const auto m = static_cast<std::size_t>(worst->match->mesh);
  comparison.say(fmt::format(
      "{}{}: {} of its {}, {} % of its surface, {} not in the {}: the largest gap is {} mm, at "
      "vertices {}, {}, {}",
      in_second ? "the second's " : "",
      label("mesh", surfaces.own.meshes[m].name, worst->match->mesh), grouped(count),
      counted(static_cast<long long>(triangles.size()), "triangle"),
      readable(100 * missing / all_area, 2), count == 1 ? "is" : "are",
      in_second ? "first" : "second", readable(1000 * worst->gap, 3), worst->corners[0],
      worst->corners[1], worst->corners[2]));
  report_turned();
}

void compare_areas(SceneComparison& comparison, const SurfaceGroup& group,
                   const SurfaceMoments& first, const SurfaceMoments& second) {
  // Files of points alone have no area; meshes of lines have lost theirs.
  const auto is_cloud = [](const SurfaceMoments& scene, const std::vector<int>& meshes) {
    return std::ranges::all_of(meshes, [&](int index) {
      const SceneMesh& mesh = scene.meshes[static_cast<std::size_t>(index)];
      return mesh.triangles.empty() && mesh.only_points;
    });
  };
  if (is_cloud(first, group.first) || is_cloud(second, group.second)) return;
  const auto name_of = [](const auto& area) -> const std::string& { return area.first; };
  auto a = areas_of(first, group.first, true), b = areas_of(second, group.second, true);
  // Materials of other names are compared elsewhere; their surfaces then are as a whole.
  if (!std::ranges::equal(a, b, {}, name_of, name_of)) {
    a = areas_of(first, group.first, false);
    b = areas_of(second, group.second, false);
  }
  for (const auto& [name, ours] : a) {
    const MaterialArea& theirs = b[name];
    const double larger = std::max(ours.area, theirs.area);
    const double moved = 0.5 * std::max(ours.perimeter, theirs.perimeter) *
                         std::max(comparison.options.tolerance.length, 0.0);
    const bool other_area = std::abs(ours.area - theirs.area) > std::max(kSameArea * larger, moved);
    if (!other_area && ours.triangles == theirs.triangles) continue;
    const auto words = [](const MaterialArea& one) {
      return fmt::format("{} of {} m2", counted(one.triangles, "triangle"), readable(one.area, 4));
    };
    const std::string text =
        fmt::format("{}{} in the first, {} in the second",
                    name.empty() ? std::string() : fmt::format("material {}: ", name), words(ours),
                    words(theirs));
    comparison.report((other_area ? "another area: " : "") + text, other_area);
  }
}

}  // namespace krok::compare
