#include "compare/surface_fit_internal.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "compare/material_difference.h"
#include "compare/measure.h"
#include "compare/mesh_difference.h"

namespace krok::compare {

namespace {

constexpr double kBack = -0.5;  // cosine of the angle to a face seen from behind

// How well a point fits a vertex over the probed moments.
struct Fit {
  double distance = 0;  // the largest
  double angle = 0;     // max, of normals; 0 if one has none
  bool behind = false;  // at the first moment, see lies_behind()
  bool other_material = false;
  double tangents = 0;    // max, see tangents_apart(); 0 if both have none
  double attributes = 0;  // distance of texture coordinates and colours; 0 if one has none

  // Radians and units of texture coordinates and colours: the point that was the vertex is off in
  // none of them, while others are off in some.
  auto rank() const { return std::tuple(behind, other_material, tangents + attributes + angle); }
};

// The mean normal of the triangles at each vertex, by area, of their front faces: 1 long where they
// are flat, shorter at an edge, and 0 without triangles.
Points faces_of(const SceneMesh& mesh, const Points& positions, int winding) {
  Points faces(positions.size(), Vec3::Zero());
  std::vector<double> areas(positions.size(), 0.0);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 normal =
        (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]);
    for (const std::uint32_t corner : t) {
      faces[corner] += winding * normal;
      areas[corner] += normal.norm();
    }
  }
  for (std::size_t v = 0; v < faces.size(); ++v) {
    if (areas[v] > 0) faces[v] /= areas[v];
  }
  return faces;
}

}  // namespace

std::vector<Points> all_faces(const SurfaceMoments& scene) {
  std::vector<Points> faces;
  const SceneState& state = scene.states[0];
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    faces.push_back(faces_of(scene.meshes[m], state.positions[m],
                             winding_of(state.windings, static_cast<int>(m))));
  }
  return faces;
}

bool lies_behind(const SurfacePoint& point, const SurfaceMoments& own, std::size_t mesh,
                 std::size_t vertex, const SurfaceMoments& other) {
  return own.faces[mesh][vertex].dot(value_at(point, other.faces)) < kBack;
}

namespace {

bool look_alike(const SceneComparison& comparison, const SceneMesh& first,
                const SceneMesh& second) {
  if (!comparison.first.knows_materials || !comparison.second.knows_materials) return true;
  if (first.material == nullptr || second.material == nullptr) {
    return first.material == second.material;
  }
  const double tolerance = comparison.options.tolerance.ratio;
  const ImageDistance& images = comparison.options.images;
  return differences(*first.material, *second.material, tolerance, images).empty() &&
         differences(first.material_parameters, second.material_parameters, tolerance, images)
             .empty();
}

}  // namespace

SameMaterials same_materials(const SceneComparison& comparison, const SurfaceMoments& own,
                             const SurfaceMoments& other) {
  SameMaterials table;
  for (const SceneMesh& mesh : own.meshes) {
    auto& row = table.emplace_back();
    for (const SceneMesh& one : other.meshes) row.push_back(look_alike(comparison, mesh, one));
  }
  return table;
}

namespace {

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

Fit fit_of(const SurfacePoint& point, const Surfaces& surfaces, int mesh, std::size_t vertex) {
  const SurfaceMoments& own = surfaces.own;
  const SurfaceMoments& other = surfaces.other;
  Fit fit;
  const auto m = static_cast<std::size_t>(mesh);
  fit.behind = lies_behind(point, own, m, vertex, other);
  fit.other_material = !surfaces.same_materials[m][static_cast<std::size_t>(point.mesh)];
  const auto add = [&](const auto& ours, const auto& theirs) {
    if (ours.empty() || theirs.empty()) return;
    fit.attributes += static_cast<double>((ours[vertex] - value_in(point, theirs)).norm());
  };
  const SceneMesh& partner = mesh_of(point, other);
  add(own.meshes[m].texture_coordinates, partner.texture_coordinates);
  add(own.meshes[m].colours, partner.colours);
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

// Of the points at most `most` away, the one whose attributes together fit best: it decides at
// seams and hard edges, where vertices are at one place.
std::size_t best_of(const std::vector<Fit>& fits, double most) {
  std::size_t best = fits.size();
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const Fit& fit = fits[i];
    if (fit.distance > most) continue;
    if (best == fits.size() || fit.rank() < fits[best].rank()) best = i;
  }
  return best;
}

}  // namespace

namespace {

double distance_over_moments(const SurfacePoint& point, const Surfaces& surfaces, int mesh,
                             std::size_t vertex) {
  double largest = 0;
  for (std::size_t k = 0; k < surfaces.own.states.size(); ++k) {
    const Vec3& place = surfaces.own.states[k].positions[static_cast<std::size_t>(mesh)][vertex];
    largest =
        std::max(largest, (place - value_at(point, surfaces.other.states[k].positions)).norm());
  }
  return largest;
}

// The joints of a part of the body share at least so much of its vertices' weights.
constexpr double kSamePart = 0.5;

// Whether a point hangs on other joints than the vertex: on an arm that touches the trunk.
bool is_other_part(const SurfacePoint& point, const Surfaces& surfaces, int mesh,
                   std::size_t vertex) {
  const SkinInfluences& own = surfaces.own.meshes[static_cast<std::size_t>(mesh)].influences;
  const SkinInfluences& other = mesh_of(point, surfaces.other).influences;
  if (own.per_vertex == 0 || other.per_vertex == 0) return false;
  const auto places = static_cast<std::size_t>(own.per_vertex);
  const auto their_places = static_cast<std::size_t>(other.per_vertex);
  double shared = 0;
  for (std::size_t i = vertex * places; i < (vertex + 1) * places; ++i) {
    double theirs = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t first = point.corners[k] * their_places;
      for (std::size_t n = first; n < first + their_places; ++n) {
        if (surfaces.own_joints[other.joints[n]] != int{own.joints[i]}) continue;
        theirs += point.shares[k] * static_cast<double>(other.weights[n]);
      }
    }
    shared += std::min(static_cast<double>(own.weights[i]), theirs);
  }
  return shared < kSamePart;
}

}  // namespace

ChosenPoints choose(std::vector<SurfacePoint> points, const Surfaces& surfaces, int mesh,
                    std::size_t vertex) {
  const auto is_other = [&](const SurfacePoint& point) {
    return is_other_part(point, surfaces, mesh, vertex);
  };
  const bool other_part = std::ranges::all_of(points, is_other);
  if (!other_part) std::erase_if(points, is_other);
  if (points.size() == 1) {
    return {points.front(), points.front(),
            distance_over_moments(points.front(), surfaces, mesh, vertex), other_part};
  }
  std::vector<Fit> fits;
  double least = std::numeric_limits<double>::infinity();
  for (const SurfacePoint& point : points) {
    fits.push_back(fit_of(point, surfaces, mesh, vertex));
    least = std::min(least, fits.back().distance);
  }
  const double touching = least + surfaces.tree.touching();
  return {points[best_of(fits, touching)], points[best_of(fits, std::max(touching, surfaces.near))],
          least, other_part};
}

}  // namespace krok::compare
