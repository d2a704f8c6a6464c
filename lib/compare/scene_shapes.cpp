#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compare/material_difference.h"
#include "compare/scene_comparison_internal.h"

namespace krok::compare {

namespace {

void compare_targets(SceneComparison& comparison, const SceneMesh& a, const SceneMesh& b,
                     const std::string& name, ValueLocation place) {
  if (a.targets.size() != b.targets.size()) {
    std::string text = fmt::format("{}: {} morph targets in the first, {} in the second", name,
                                   a.targets.size(), b.targets.size());
    // A skinned mesh (possibly with targets) against one without a skin is a rig against its baked
    // motion.
    const bool first_skinned = a.influences.per_vertex > 0;
    const bool second_skinned = b.influences.per_vertex > 0;
    if (first_skinned != second_skinned) {
      comparison.note(std::move(text));
    } else {
      comparison.say(std::move(text));
    }
    return;
  }
  const std::vector<Vec3f> none(a.targets.empty() ? 0 : a.vertex_count, Vec3f::Zero());
  const auto or_none = [&](std::span<const Vec3f> values) {
    return values.empty() ? std::span<const Vec3f>(none) : values;
  };
  const ListMatch match =
      match_lists(names_of(a.targets), names_of(b.targets), comparison.options.matching);
  for (const int missing : match.only_first) {
    const auto& target = a.targets[static_cast<std::size_t>(missing)].name;
    comparison.say(
        fmt::format("{}: {} is only in the first", name, label("morph target", target, missing)));
  }
  for (const auto& [i, j] : match.pairs) {
    const SceneMesh::Target& target = a.targets[static_cast<std::size_t>(i)];
    const SceneMesh::Target& other = b.targets[static_cast<std::size_t>(j)];
    place.target = i;
    add_distances(or_none(target.positions), or_none(other.positions), place,
                  comparison.result.target_positions);
    if (!target.normals.empty() || !other.normals.empty()) {
      add_distances(or_none(target.normals), or_none(other.normals), place,
                    comparison.result.target_normals);
    }
    if (a.has_tangents && b.has_tangents && (!target.tangents.empty() || !other.tangents.empty())) {
      add_distances(or_none(target.tangents), or_none(other.tangents), place,
                    comparison.result.target_tangents);
    }
  }
}

void compare_weights(SceneComparison& comparison, const SceneMesh& a, const SceneMesh& b,
                     const std::string& name, ValueLocation place) {
  const bool first_has = a.influences.per_vertex > 0;
  const bool second_has = b.influences.per_vertex > 0;
  if (first_has && second_has) {
    if (comparison.joints.empty()) return;
    add_weight_differences(a.influences, b.influences, comparison.first_joint_of_second, place,
                           comparison.result.weights);
  } else if (first_has || second_has) {
    comparison.note(
        fmt::format("{}: only the {} has a skin", name, first_has ? "first" : "second"));
  }
}

void say_only_one_has(SceneComparison& comparison, const std::string& name, const char* what,
                      bool first_has, bool second_has) {
  if (first_has == second_has) return;
  comparison.say(fmt::format("{}: only the {} has {}", name, first_has ? "first" : "second", what));
}

// Meshes often share a material; its differences are reported once.
void compare_materials(SceneComparison& comparison, const SceneMesh& a, const SceneMesh& b,
                       const std::string& name) {
  if (!comparison.first.knows_materials || !comparison.second.knows_materials) return;
  if (!comparison.materials.emplace(a.material, b.material).second) return;
  std::string text;
  if (a.material != nullptr && b.material != nullptr) {
    text = fmt::format(
        "{}",
        fmt::join(differences(*a.material, *b.material, comparison.options.tolerance.ratio), "; "));
  } else if (a.material != b.material) {
    text = fmt::format("only the {} has one", a.material != nullptr ? "first" : "second");
  }
  if (text.empty()) return;
  text = fmt::format("{}, material: {}", name, text);
  if (comparison.options.materials) {
    comparison.say(std::move(text));
  } else {
    comparison.note(std::move(text));
  }
}

}  // namespace

bool has_normal_texture(const SceneMesh& mesh) {
  return mesh.material != nullptr && mesh.material->normal_texture.image != nullptr;
}

void report_tangents(SceneComparison& comparison, const std::string& before, bool first_has,
                     bool shown) {
  std::string text =
      fmt::format("{}only the {} has tangents", before, first_has ? "first" : "second");
  // Formats without materials may omit tangents, or have unused ones.
  if (shown && comparison.first.knows_materials && comparison.second.knows_materials) {
    comparison.say(text + ", which normal textures need");
  } else {
    comparison.note(text + ", so they are not compared");
  }
}

void compare_shapes(SceneComparison& comparison, int first_mesh, int second_mesh) {
  const SceneMesh& a = comparison.first.meshes[static_cast<std::size_t>(first_mesh)];
  const SceneMesh& b = comparison.second.meshes[static_cast<std::size_t>(second_mesh)];
  const std::string name = label("mesh", a.name, first_mesh);
  const ValueLocation place{.mesh = first_mesh};
  if (a.only_points || b.only_points) return;
  if (std::string text = difference_in_triangles(a.triangles, b.triangles); !text.empty()) {
    comparison.say(fmt::format("{}: {}", name, text));
  }
  say_only_one_has(comparison, name, "normals", a.has_normals, b.has_normals);
  if (a.has_tangents != b.has_tangents) {
    report_tangents(comparison, name + ": ", a.has_tangents,
                    has_normal_texture(a) && has_normal_texture(b));
  }
  say_only_one_has(comparison, name, "texture coordinates", !a.texture_coordinates.empty(),
                   !b.texture_coordinates.empty());
  if (!a.texture_coordinates.empty() && !b.texture_coordinates.empty()) {
    add_coordinate_differences(a.texture_coordinates, b.texture_coordinates, place,
                               comparison.result.texture_coordinates);
  }
  compare_targets(comparison, a, b, name, place);
  compare_weights(comparison, a, b, name, place);
  compare_materials(comparison, a, b, name);
}

}  // namespace krok::compare
