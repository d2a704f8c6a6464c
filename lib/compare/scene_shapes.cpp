#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "compare/material_difference.h"
#include "compare/mesh_difference.h"
#include "compare/scene_comparison_internal.h"

namespace krok::compare {

namespace {

bool share_a_name(const SceneMesh& a, const SceneMesh& b) {
  return std::ranges::any_of(a.targets, [&](const SceneMesh::Target& one) {
    return !one.name.empty() && std::ranges::any_of(b.targets, [&](const SceneMesh::Target& other) {
      return other.name == one.name;
    });
  });
}

// A mesh that plays its motion by a skin or by morph targets, against one that plays it by other
// morph targets, made for that: a rig and its bake, or two bakes.
bool is_bake_of(const SceneMesh& a, const SceneMesh& b) {
  const bool first_skinned = a.influences.per_vertex > 0;
  const bool second_skinned = b.influences.per_vertex > 0;
  if (first_skinned != second_skinned) return true;
  return a.animates_weights && b.animates_weights && !share_a_name(a, b);
}

constexpr int kNamesShown = 3;

// The displacements of a morph target in world space.
SceneMesh::Target displaced(const ScenePlacement& placement, const SceneMesh& mesh, int mesh_index,
                            int target, ScenePlacement::Memory& memory) {
  if (placement.displace) return placement.displace(mesh_index, target, memory);
  return mesh.targets[static_cast<std::size_t>(target)];
}

bool moves_nothing(const ScenePlacement& placement, const SceneMesh& mesh, int mesh_index) {
  ScenePlacement::Memory memory;
  const auto is_zero = [](const Vec3f& value) { return value.isZero(0); };
  for (int t = 0; t < static_cast<int>(mesh.targets.size()); ++t) {
    const auto target = displaced(placement, mesh, mesh_index, t, memory);
    for (const auto& values : {target.positions, target.normals, target.tangents}) {
      if (!std::ranges::all_of(values, is_zero)) return false;
    }
  }
  return true;
}

void compare_targets(SceneComparison& comparison, std::pair<int, int> meshes,
                     const std::string& name, ValueLocation place) {
  const SceneMesh& a = comparison.first.meshes[static_cast<std::size_t>(meshes.first)];
  const SceneMesh& b = comparison.second.meshes[static_cast<std::size_t>(meshes.second)];
  if (a.targets.size() != b.targets.size()) {
    std::string text = fmt::format("{}: {} morph targets in the first, {} in the second", name,
                                   a.targets.size(), b.targets.size());
    if ((a.targets.empty() && moves_nothing(comparison.second_placement, b, meshes.second)) ||
        (b.targets.empty() && moves_nothing(comparison.first_placement, a, meshes.first))) {
      comparison.note(text + ", which move nothing");
    } else if (comparison.options.matching != Matching::name && is_bake_of(a, b)) {
      comparison.note(text + "; compared by their effect only");
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
  ScenePlacement::Memory first_memory, second_memory;
  for (const auto& [i, j] : match.pairs) {
    const auto target = displaced(comparison.first_placement, a, meshes.first, i, first_memory);
    const auto other = displaced(comparison.second_placement, b, meshes.second, j, second_memory);
    place.target = i;
    const Matching matching = comparison.options.matching;
    // Bakes have hundreds of them.
    const bool bake = is_bake_of(a, b);
    if (matching != Matching::order && (!bake || i < kNamesShown)) {
      report_name(comparison, "morph target", a.targets[static_cast<std::size_t>(i)].name,
                  b.targets[static_cast<std::size_t>(j)].name, !bake);
    }
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

// Vertex colours, and texture coordinates beside the first set.
void compare_attributes(SceneComparison& comparison, std::pair<int, int> meshes,
                        const std::string& name, ValueLocation place) {
  const SceneMesh& a = comparison.first.meshes[static_cast<std::size_t>(meshes.first)];
  const SceneMesh& b = comparison.second.meshes[static_cast<std::size_t>(meshes.second)];
  if (a.colours.empty() != b.colours.empty()) {
    if (a.is_painted() || b.is_painted()) {
      comparison.report(fmt::format("{}: only the {} has vertex colours", name,
                                    a.colours.empty() ? "second" : "first"),
                        comparison.options.materials);
    }
  } else {
    add_colour_differences(a.colours, b.colours, place, comparison.result.colours);
  }
  const auto set_of = [](const SceneMesh& mesh, std::size_t set) {
    return set < mesh.more_texture_coordinates.size() ? mesh.more_texture_coordinates[set]
                                                      : std::span<const Vec2f>();
  };
  const std::size_t sets =
      std::max(a.more_texture_coordinates.size(), b.more_texture_coordinates.size());
  for (std::size_t set = 0; set < sets; ++set) {
    const auto ours = set_of(a, set), theirs = set_of(b, set);
    if (ours.empty() != theirs.empty()) {
      const bool used = comparison.first_textures.uses(meshes.first, set + 1) ||
                        comparison.second_textures.uses(meshes.second, set + 1);
      comparison.report(fmt::format("{}: only the {} has texture coordinates {}{}", name,
                                    ours.empty() ? "second" : "first", set + 1,
                                    used ? "" : ", which no texture uses"),
                        used || comparison.options.materials);
    } else {
      add_coordinate_differences(ours, theirs, place, comparison.result.texture_coordinates);
    }
  }
}

// Whether the meshes face the same way, by their triangles and how they are placed.
void compare_triangles(SceneComparison& comparison, std::pair<int, int> meshes,
                       const std::string& name) {
  const SceneMesh& a = comparison.first.meshes[static_cast<std::size_t>(meshes.first)];
  const SceneMesh& b = comparison.second.meshes[static_cast<std::size_t>(meshes.second)];
  const bool mirrored = winding_of(comparison.first_placement.windings, meshes.first) *
                            winding_of(comparison.second_placement.windings, meshes.second) <
                        0;
  if (!mirrored) {
    std::string text = difference_in_triangles(a.triangles, b.triangles);
    if (text.empty()) return;
    if (difference_in_triangles(a.triangles, reversed(b.triangles)).empty()) {
      text = "inside out in the second: its triangles are wound the other way";
    }
    comparison.say(fmt::format("{}: {}", name, text));
    return;
  }
  const std::string text = difference_in_triangles(a.triangles, reversed(b.triangles));
  if (text.empty()) return;
  if (difference_in_triangles(a.triangles, b.triangles).empty()) {
    comparison.say(fmt::format(
        "{}: inside out in the second: its triangles are the same, but only one of the nodes "
        "mirrors",
        name));
  } else {
    comparison.say(fmt::format(
        "{}: {} (with the second's reversed, as only one of the nodes mirrors)", name, text));
  }
}

}  // namespace

// Meshes often share a material; its differences are reported once.
void compare_materials(SceneComparison& comparison, const SceneMesh& a, const SceneMesh& b,
                       const std::string& name) {
  if (!comparison.first.knows_materials || !comparison.second.knows_materials) return;
  if (!comparison.materials.emplace(a.material, b.material).second) return;
  std::string text;
  if (a.material != nullptr && b.material != nullptr) {
    const double tolerance = comparison.options.tolerance.ratio;
    const ImageDistance& images = comparison.options.images;
    auto found = differences(*a.material, *b.material, tolerance, images);
    for (std::string& one :
         differences(a.material_parameters, b.material_parameters, tolerance, images)) {
      found.push_back(std::move(one));
    }
    const std::string &one = a.material->name, &other = b.material->name;
    const bool renamed = one != other && !one.empty() && !other.empty();
    if (renamed && comparison.options.matching != Matching::order) {
      found.push_back(fmt::format("named {} and {}", one, other));
    }
    text = fmt::format("{}", fmt::join(found, "; "));
  } else if (a.material != b.material) {
    text = fmt::format("only the {} has one", a.material != nullptr ? "first" : "second");
  }
  if (text.empty()) return;
  comparison.report(fmt::format("{}, material: {}", name, text), comparison.options.materials);
}

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

namespace {

void compare_pair(SceneComparison& comparison, std::pair<int, int> meshes) {
  const SceneMesh& a = comparison.first.meshes[static_cast<std::size_t>(meshes.first)];
  const SceneMesh& b = comparison.second.meshes[static_cast<std::size_t>(meshes.second)];
  const std::string name = label("mesh", a.name, meshes.first);
  const ValueLocation place{.mesh = meshes.first};
  if (a.only_points || b.only_points) return;
  compare_triangles(comparison, meshes, name);
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
  if (a.visible != b.visible) {
    comparison.say(fmt::format("{}: hidden in the {}", name, a.visible ? "second" : "first"));
  }
  compare_attributes(comparison, meshes, name, place);
  compare_targets(comparison, meshes, name, place);
  compare_weights(comparison, a, b, name, place);
  compare_materials(comparison, a, b, name);
}

}  // namespace

void compare_shapes(SceneComparison& comparison) {
  for (const auto& pair : comparison.meshes) compare_pair(comparison, pair);
}

}  // namespace krok::compare
