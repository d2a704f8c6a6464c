#include "compare/model_difference.h"

#include <fmt/format.h>

#include <algorithm>

#include "compare/mesh_difference.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

// Whether both have the attribute; reports a difference of structure if only one does.
template <typename T>
bool both_have(const char* what, const std::vector<T>& first, const std::vector<T>& second,
               std::vector<std::string>& structure) {
  if (first.empty() != second.empty()) {
    structure.push_back(
        fmt::format("only the {} has {}", first.empty() ? "second" : "first", what));
  }
  return !first.empty() && !second.empty();
}

std::string difference_in_parts(const Model& first, const Model& second) {
  if (first.parts.size() != second.parts.size()) {
    return fmt::format("{} parts in the first, {} in the second", first.parts.size(),
                       second.parts.size());
  }
  for (std::size_t i = 0; i < first.parts.size(); ++i) {
    const Model::Part& a = first.parts[i];
    const Model::Part& b = second.parts[i];
    if (a.name != b.name) {
      return fmt::format("part {} is named '{}' in the first and '{}' in the second", i, a.name,
                         b.name);
    }
    if (a.material != b.material) {
      return fmt::format("part {} ({}) has the material '{}' in the first and '{}' in the second",
                         i, a.name, a.material, b.material);
    }
    if (a.triangle_count != b.triangle_count) {
      return fmt::format("part {} ({}) has {} triangles in the first and {} in the second", i,
                         a.name, a.triangle_count, b.triangle_count);
    }
  }
  return {};
}

// Parts may have different triangle ranges, so each is compared separately.
std::string difference_in_surface(const Model& first, const Model& second) {
  if (first.triangles.size() != second.triangles.size()) {
    return difference_in_triangles(first.triangles, second.triangles);
  }
  if (std::string parts = difference_in_parts(first, second); !parts.empty()) return parts;
  for (const Model::Part& part : first.parts) {
    const auto run = [&](const Model& model) {
      return std::span(model.triangles).subspan(part.first_triangle, part.triangle_count);
    };
    const std::string text = difference_in_triangles(run(first), run(second));
    if (text.empty()) continue;
    return part.name.empty() ? text : fmt::format("part {}: {}", part.name, text);
  }
  return {};
}

void compare_tangents(const Model& first, const Model& second, ModelDifference& result) {
  for (std::size_t i = 0; i < first.tangents.size(); ++i) {
    const Vec4 a = first.tangents[i].cast<double>();
    const Vec4 b = second.tangents[i].cast<double>();
    const ValueLocation place{.vertex = static_cast<int>(i)};
    result.tangents.add(angle_between_directions(a.head<3>(), b.head<3>()), place);
    result.tangent_sides.add(on_other_sides(a, b) ? 1 : 0, place);
  }
}

void compare_skeletons(const Model& first, const Model& second, const SkeletonMatch& match,
                       ModelDifference& result) {
  for (std::size_t j = 0; j < match.second_of_first.size(); ++j) {
    if (match.second_of_first[j] < 0) continue;
    const Transform& a = first.skeleton.reference[j];
    const Transform& b =
        second.skeleton.reference[static_cast<std::size_t>(match.second_of_first[j])];
    const ValueLocation place{.joint = static_cast<int>(j)};
    JointDifference joint{place.joint, Measure(result.reference_positions.tolerance),
                          Measure(result.reference_orientations.tolerance)};
    joint.positions.add((a.position - b.position).norm(), place);
    joint.orientations.add(angle_between(a.orientation, b.orientation), place);
    result.reference_positions.merge(joint.positions);
    result.reference_orientations.merge(joint.orientations);
    result.joints.push_back(std::move(joint));
  }
}

void compare_weights(const Model& first, const Model& second, const SkeletonMatch& match,
                     Measure& measure) {
  std::vector<int> first_of_second(static_cast<std::size_t>(second.skeleton.joint_count()), -1);
  for (std::size_t i = 0; i < match.second_of_first.size(); ++i) {
    if (match.second_of_first[i] < 0) continue;
    first_of_second[static_cast<std::size_t>(match.second_of_first[i])] = static_cast<int>(i);
  }
  const auto influences = [](const Model& model) {
    return Influences{model.influences_per_vertex, model.influence_joints, model.influence_weights};
  };
  add_weight_differences(influences(first), influences(second), first_of_second, {}, measure);
}

}  // namespace

bool ModelDifference::same() const {
  return structure.empty() && reference_positions.within() && reference_orientations.within() &&
         positions.within() && normals.within() && texture_coordinates.within() &&
         colours.within() && tangents.within() && tangent_sides.within() && weights.within();
}

Result<ModelDifference> difference(const Model& first, const Model& second,
                                   const Tolerance& tolerance, Matching matching) {
  for (const Model* model : {&first, &second}) {
    if (auto ok = check(*model); !ok) {
      Error error = ok.error();
      error.message =
          fmt::format("the {} model: {}", model == &first ? "first" : "second", error.message);
      return error;
    }
  }
  ModelDifference result;
  result.positions = Measure(tolerance.length);
  result.normals = result.tangents = Measure(tolerance.of_normals());
  result.reference_positions = Measure(tolerance.of_joint_positions());
  result.reference_orientations = Measure(tolerance.of_joint_orientations());
  result.texture_coordinates = result.colours = result.weights = Measure(tolerance.ratio);

  const SkeletonMatch skeletons = match_skeletons(first.skeleton, second.skeleton, matching);
  compare_skeletons(first, second, skeletons, result);
  if (!skeletons.difference.empty()) {
    result.structure.push_back("skeletons differ: " + skeletons.difference);
  }

  if (first.vertex_count() != second.vertex_count()) {
    result.structure.push_back(fmt::format("{} vertices in the first, {} in the second",
                                           first.vertex_count(), second.vertex_count()));
    return result;
  }
  if (std::string text = difference_in_surface(first, second); !text.empty()) {
    result.structure.push_back(std::move(text));
  }
  add_distances(std::span(first.positions), second.positions, {}, result.positions);
  if (both_have("normals", first.normals, second.normals, result.structure)) {
    add_angles(std::span(first.normals), second.normals, {}, result.normals);
  }
  if (both_have("texture coordinates", first.texture_coordinates, second.texture_coordinates,
                result.structure)) {
    add_coordinate_differences(first.texture_coordinates, second.texture_coordinates, {},
                               result.texture_coordinates);
  }
  if (first.more_texture_coordinates.size() != second.more_texture_coordinates.size()) {
    result.structure.push_back(
        fmt::format("{} further sets of texture coordinates in the first, {} in the second",
                    first.more_texture_coordinates.size(), second.more_texture_coordinates.size()));
  }
  for (std::size_t s = 0;
       s < std::min(first.more_texture_coordinates.size(), second.more_texture_coordinates.size());
       ++s) {
    add_coordinate_differences(first.more_texture_coordinates[s],
                               second.more_texture_coordinates[s], {}, result.texture_coordinates);
  }
  if (both_have("vertex colours", first.colours, second.colours, result.structure)) {
    add_colour_differences(first.colours, second.colours, {}, result.colours);
  }
  if (both_have("tangents", first.tangents, second.tangents, result.structure)) {
    compare_tangents(first, second, result);
  }
  if (!skeletons.second_of_first.empty()) compare_weights(first, second, skeletons, result.weights);
  return result;
}

}  // namespace krok::compare
