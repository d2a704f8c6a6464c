#include "compare/scene_difference.h"

#include "compare/scene_comparison_internal.h"

namespace krok::compare {

namespace {

void set_tolerances(const Tolerance& tolerance, SceneDifference& result) {
  result.positions = result.target_positions = Measure(tolerance.length);
  result.normals = result.tangents = Measure(tolerance.of_normals());
  result.joint_positions = Measure(tolerance.of_joint_positions());
  result.joint_orientations = Measure(tolerance.of_joint_orientations());
  result.target_normals = result.target_tangents = Measure(tolerance.ratio);
  result.texture_coordinates = result.weights = Measure(tolerance.ratio);
  result.times = Measure(tolerance.time);
}

}  // namespace

bool SceneDifference::same() const {
  return structure.empty() && positions.within() && normals.within() && tangents.within() &&
         tangent_sides.within() && joint_positions.within() && joint_orientations.within() &&
         target_positions.within() && target_normals.within() && target_tangents.within() &&
         texture_coordinates.within() && weights.within();
}

Result<SceneDifference> difference(const Scene& first, const Scene& second,
                                   const SceneOptions& options, int jobs, Progress& progress) {
  SceneComparison comparison{first, second, options};
  set_tolerances(options.tolerance, comparison.result);
  match_scene_joints(comparison);
  match_scene_meshes(comparison);
  if (Status status = choose_moments(comparison); !status) return status.error();
  if (Status status = match_surfaces(comparison, jobs); !status) return status.error();
  if (Status status = compare_moments(comparison, jobs, progress); !status) return status.error();
  return std::move(comparison.result);
}

}  // namespace krok::compare
