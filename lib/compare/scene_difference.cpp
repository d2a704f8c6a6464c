#include "compare/scene_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "compare/nearest_triangle_internal.h"
#include "compare/scene_comparison_internal.h"

namespace krok::compare {

namespace {

void set_tolerances(const SceneOptions& options, SceneDifference& result) {
  const Tolerance& tolerance = options.tolerance;
  result.positions = result.target_positions = Measure(tolerance.length);
  result.normals = result.tangents = Measure(tolerance.of_normals());
  result.joint_positions = Measure(tolerance.of_joint_positions());
  result.joint_orientations = Measure(tolerance.of_joint_orientations());
  result.target_normals = result.target_tangents = Measure(tolerance.ratio);
  result.texture_coordinates = result.weights = Measure(tolerance.ratio);
  result.colours =
      Measure(options.materials ? tolerance.ratio : std::numeric_limits<double>::infinity());
  result.times = Measure(tolerance.time);
}

void place_meshes(SceneComparison& comparison) {
  const Moment& moment = comparison.moments.front();
  if (comparison.first.place) {
    comparison.first_placement = comparison.first.place(moment.first_animation, moment.first_time);
  }
  if (comparison.second.place) {
    comparison.second_placement =
        comparison.second.place(moment.second_animation, moment.second_time);
  }
}

// Whether each of some vertices has one of `others` within a tolerance.
bool all_at_places(const std::vector<Vec3>& vertices, const std::vector<Vec3>& others,
                   double tolerance) {
  std::vector<Facet> places;
  for (std::uint32_t v = 0; v < others.size(); ++v) {
    places.push_back({0, {v, v, v}, {others[v], others[v], others[v]}});
  }
  const auto tree = places.empty() ? nullptr : FacetTree::create(std::move(places));
  std::vector<FoundFacet> found;
  return tree != nullptr && std::ranges::all_of(vertices, [&](const Vec3& place) {
           tree->find(place, found);
           return std::ranges::any_of(
               found, [&](const FoundFacet& one) { return one.distance <= tolerance; });
         });
}

// Vertices that are over the tolerance by index, all of which have others at their places.
void note_other_order(SceneComparison& comparison) {
  const Tolerance& tolerance = comparison.options.tolerance;
  const Moment& moment = comparison.moments.front();
  SceneState a, b;
  for (std::size_t k = 0; k < comparison.meshes.size(); ++k) {
    const auto [i, j] = comparison.meshes[k];
    if (comparison.result.parts[k].positions.within()) continue;
    if (a.positions.empty()) {
      comparison.first.evaluate(moment.first_animation, moment.first_time, a);
      comparison.second.evaluate(moment.second_animation, moment.second_time, b);
    }
    const auto& ours = a.positions[static_cast<std::size_t>(i)];
    const auto& theirs = b.positions[static_cast<std::size_t>(j)];
    // Both ways: a vertex of a seam that moved leaves another at its place.
    const std::size_t shared = std::min(ours.size(), theirs.size());
    const bool all = all_at_places(ours, theirs, tolerance.length) &&
                     all_at_places(theirs, ours, tolerance.length);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < shared; ++v) {
      moved += (ours[v] - theirs[v]).norm() > tolerance.length ? 1 : 0;
    }
    if (!all || moved == 0) continue;
    comparison.note(fmt::format(
        "{}: its vertices are at the places of the second's, {} of them under another index; "
        "--match nearest compares surfaces, whatever their vertices",
        label("mesh", comparison.first.meshes[static_cast<std::size_t>(i)].name, i), moved));
  }
}

void add_last_notes(SceneComparison& comparison) {
  note_other_order(comparison);
  const Measure& colours = comparison.result.colours;
  if (!comparison.options.materials && colours.largest > comparison.options.tolerance.ratio) {
    comparison.note("vertex colours differ, which counts with materials only");
  }
}

}  // namespace

int winding_of(const std::vector<int>& windings, int mesh) {
  const auto i = static_cast<std::size_t>(mesh);
  return i < windings.size() ? windings[i] : 1;
}

bool SceneDifference::same() const {
  return structure.empty() && positions.within() && normals.within() && tangents.within() &&
         tangent_sides.within() && joint_positions.within() && joint_orientations.within() &&
         target_positions.within() && target_normals.within() && target_tangents.within() &&
         texture_coordinates.within() && colours.within() && weights.within();
}

Result<SceneDifference> difference(const Scene& first, const Scene& second,
                                   const SceneOptions& options, int jobs, Progress& progress) {
  const UsedTextures used(first), other_used(second);
  SceneComparison comparison{used, other_used, used.scene, other_used.scene, options};
  set_tolerances(options, comparison.result);
  match_scene_joints(comparison);
  match_scene_meshes(comparison);
  if (Status status = choose_moments(comparison); !status) return status.error();
  compare_rest_pose(comparison);
  compare_places(comparison);
  place_meshes(comparison);
  compare_shapes(comparison);
  if (Status status = match_surfaces(comparison, jobs); !status) return status.error();
  if (Status status = compare_moments(comparison, jobs, progress); !status) return status.error();
  add_last_notes(comparison);
  return std::move(comparison.result);
}

}  // namespace krok::compare
