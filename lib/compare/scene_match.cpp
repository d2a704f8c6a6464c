#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "compare/scene_comparison_internal.h"
#include "compare/skeleton_match.h"
#include "core/numbers.h"

namespace krok::compare {

namespace {

constexpr std::size_t kShown = 5;

// "Hat, Scarf and 3 more"
std::string list_of(const char* kind, const std::vector<std::string>& names,
                    const std::vector<int>& items) {
  std::string list;
  for (std::size_t i = 0; i < std::min(items.size(), kShown); ++i) {
    list += i == 0 ? "" : ", ";
    list += label(kind, names[static_cast<std::size_t>(items[i])], items[i]);
  }
  if (items.size() > kShown) list += fmt::format(" and {} more", items.size() - kShown);
  return list;
}

void say_partners_missing(SceneComparison& comparison, const ListMatch& match,
                          const std::vector<std::string>& first,
                          const std::vector<std::string>& second) {
  const bool by_name = comparison.options.matching == Matching::name;
  if (!by_name && first.size() != second.size()) {
    comparison.say(fmt::format("{} in the first, {} in the second",
                               counted(static_cast<long long>(first.size()), "mesh", "meshes"),
                               second.size()));
  }
  if (by_name || comparison.options.matching == Matching::automatic) {
    if (!match.only_first.empty()) {
      comparison.say("only in the first: " + list_of("mesh", first, match.only_first));
    }
    if (!match.only_second.empty()) {
      comparison.say("only in the second: " + list_of("mesh", second, match.only_second));
    }
  }
}

// Meshes of names that both have once; then, in order, those with as many vertices, where there
// are other numbers of meshes; then all others in order. Notes which way was taken.
ListMatch match_meshes(SceneComparison& comparison) {
  const auto &first = comparison.first.meshes, &second = comparison.second.meshes;
  ListMatch match;
  std::vector<char> taken(second.size(), 0);
  std::vector<int> left;
  std::map<std::string, std::vector<int>> named[2];
  for (int s = 0; s < 2; ++s) {
    const auto& meshes = s == 0 ? first : second;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      named[s][meshes[i].name].push_back(static_cast<int>(i));
    }
  }
  const auto pair = [&](int i, int j) {
    match.pairs.emplace_back(i, j);
    taken[static_cast<std::size_t>(j)] = 1;
  };
  for (std::size_t i = 0; i < first.size(); ++i) {
    const std::string& name = first[i].name;
    const auto other = named[1].find(name);
    const bool once = !name.empty() && other != named[1].end() && other->second.size() == 1 &&
                      named[0][name].size() == 1;
    once ? pair(static_cast<int>(i), other->second[0]) : left.push_back(static_cast<int>(i));
  }
  // Names that are shifted against the meshes, as some programs number them anew.
  const auto count = [](const SceneMesh& mesh) { return mesh.vertex_count; };
  const bool names_fit = std::ranges::all_of(match.pairs, [&](const auto& one) {
    return count(first[static_cast<std::size_t>(one.first)]) ==
           count(second[static_cast<std::size_t>(one.second)]);
  });
  if (!names_fit && std::ranges::equal(first, second, {}, count, count)) {
    match = {};
    for (int i = 0; i < std::ssize(first); ++i) match.pairs.emplace_back(i, i);
    comparison.note(
        "meshes are matched by their order: of those with the same names, the numbers "
        "of vertices differ");
    return match;
  }
  const std::size_t by_name = match.pairs.size();
  for (const bool same_size : {true, false}) {
    if (same_size && first.size() == second.size()) continue;
    std::vector<int> still;
    std::size_t j = 0;
    for (const int i : left) {
      while (!same_size && j < second.size() && taken[j] != 0) ++j;
      std::size_t k = j;
      while (same_size && k < second.size() &&
             (taken[k] != 0 ||
              second[k].vertex_count != first[static_cast<std::size_t>(i)].vertex_count)) {
        ++k;
      }
      k < second.size() ? pair(i, static_cast<int>(k)) : still.push_back(i);
    }
    left = std::move(still);
  }
  match.only_first = std::move(left);
  for (std::size_t j = 0; j < second.size(); ++j) {
    if (taken[j] == 0) match.only_second.push_back(static_cast<int>(j));
  }
  std::ranges::sort(match.pairs);
  const bool in_order =
      std::ranges::all_of(match.pairs, [](const auto& one) { return one.first == one.second; });
  if (by_name < match.pairs.size() && (by_name > 0 || !in_order)) {
    comparison.note(
        fmt::format("{} of {} matched by name, the others by their order", by_name,
                    counted(std::ssize(match.pairs), "pair of meshes is", "pairs of meshes are")));
  } else if (!in_order) {
    comparison.note("meshes are matched by name, as their order differs");
  }
  return match;
}

// The meshes of each name: those of a node belong together, whatever the order of its parts.
std::map<std::string, std::vector<int>> by_name(const std::vector<SceneMesh>& meshes) {
  std::map<std::string, std::vector<int>> groups;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const std::string& node = meshes[i].node_name;
    groups[node.empty() ? meshes[i].name : node].push_back(static_cast<int>(i));
  }
  return groups;
}

// One group per name if both scenes have the same names, or one for everything.
std::vector<SurfaceGroup> groups_of(const std::vector<SceneMesh>& first,
                                    const std::vector<SceneMesh>& second) {
  std::vector<SurfaceGroup> groups;
  if (first.empty() || second.empty()) return groups;
  const auto firsts = by_name(first), seconds = by_name(second);
  const bool same = std::ranges::equal(
      firsts, seconds, {}, [](const auto& one) { return one.first; },
      [](const auto& one) { return one.first; });
  if (same && !firsts.contains("")) {
    for (const auto& [name, meshes] : firsts) groups.push_back({meshes, seconds.at(name)});
    return groups;
  }
  SurfaceGroup all;
  for (std::size_t i = 0; i < first.size(); ++i) all.first.push_back(static_cast<int>(i));
  for (std::size_t i = 0; i < second.size(); ++i) all.second.push_back(static_cast<int>(i));
  groups.push_back(std::move(all));
  return groups;
}

std::size_t vertices_of(const std::vector<SceneMesh>& meshes) {
  std::size_t count = 0;
  for (const SceneMesh& mesh : meshes) count += mesh.vertex_count;
  return count;
}

void report_tangents_in_groups(SceneComparison& comparison) {
  bool has[2] = {false, false}, textured[2] = {false, false};
  const std::vector<SceneMesh>* both[2] = {&comparison.first.meshes, &comparison.second.meshes};
  for (int i = 0; i < 2; ++i) {
    for (const SceneMesh& mesh : *both[i]) {
      if (mesh.only_points) return;
      has[i] = has[i] || mesh.has_tangents;
      textured[i] = textured[i] || has_normal_texture(mesh);
    }
    if (both[i]->empty()) return;
  }
  if (has[0] != has[1]) report_tangents(comparison, "", has[0], textured[0] && textured[1]);
}

void group_meshes(SceneComparison& comparison) {
  const auto& first = comparison.first.meshes;
  const auto& second = comparison.second.meshes;
  comparison.groups = groups_of(first, second);
  const auto only_points = [](const SceneMesh& mesh) { return mesh.only_points; };
  const bool of_points =
      std::ranges::any_of(first, only_points) || std::ranges::any_of(second, only_points);
  const auto report_missing = [&](const char* what, bool counts, const auto& has) {
    if (first.empty() || second.empty() || of_points) return;
    const bool first_has = std::ranges::any_of(first, has);
    if (first_has == std::ranges::any_of(second, has)) return;
    comparison.report(fmt::format("only the {} has {}", first_has ? "first" : "second", what),
                      counts);
  };
  report_missing("normals", true, [](const SceneMesh& mesh) { return mesh.has_normals; });
  report_missing("texture coordinates", true,
                 [](const SceneMesh& mesh) { return !mesh.texture_coordinates.empty(); });
  report_missing("vertex colours", comparison.options.materials,
                 [](const SceneMesh& mesh) { return mesh.is_painted(); });
  report_tangents_in_groups(comparison);
  const auto any = [&](const auto& has) {
    return std::ranges::any_of(first, has) || std::ranges::any_of(second, has);
  };
  if (any([](const SceneMesh& mesh) { return mesh.influences.per_vertex > 0; })) {
    comparison.note("skin weights are compared by their effect only, with nearest points");
  }
  if (any([](const SceneMesh& mesh) { return !mesh.targets.empty(); })) {
    comparison.note("morph targets are compared by their effect only, with nearest points");
  }
  if (first.empty() != second.empty()) {
    comparison.say(fmt::format("only the {} has meshes", first.empty() ? "second" : "first"));
  } else if (first.size() != second.size() || vertices_of(first) != vertices_of(second)) {
    const auto all = [](const std::vector<SceneMesh>& meshes) {
      return counted(static_cast<long long>(vertices_of(meshes)), "vertex", "vertices") + " in " +
             counted(static_cast<long long>(meshes.size()), "mesh", "meshes");
    };
    comparison.note(fmt::format("{} in the first, {} in the second", all(first), all(second)));
  }
}

}  // namespace

std::string label(const char* kind, const std::string& name, int index) {
  return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {}", kind, name);
}

void report_name(SceneComparison& comparison, const char* kind, const std::string& first,
                 const std::string& second, bool counts) {
  if (first == second || first.empty() || second.empty()) return;
  std::string text = fmt::format("{} {} is named {} in the second", kind, first, second);
  // Once for all parts of a mesh.
  std::vector<std::string>& texts = counts ? comparison.result.structure : comparison.result.notes;
  if (std::ranges::find(texts, text) == texts.end()) texts.push_back(std::move(text));
}

void match_scene_joints(SceneComparison& comparison) {
  const Scene& first = comparison.first;
  const Scene& second = comparison.second;
  if (first.joint_names.empty() && second.joint_names.empty()) return;
  if (first.joint_names.empty() || second.joint_names.empty()) {
    const bool first_has = second.joint_names.empty();
    // Without meshes there is nothing else to compare.
    comparison.report(fmt::format("only the {} has joints ({}), so joints are not compared",
                                  first_has ? "first" : "second",
                                  first_has ? first.joint_names.size() : second.joint_names.size()),
                      first.meshes.empty() || second.meshes.empty());
    return;
  }
  const SkeletonMatch match =
      match_joints(first.joint_names, first.joint_parents, second.joint_names, second.joint_parents,
                   comparison.options.matching);
  if (!match.difference.empty()) comparison.say("skeletons differ: " + match.difference);
  comparison.first_joint_of_second.assign(second.joint_names.size(), -1);
  for (std::size_t i = 0; i < match.second_of_first.size(); ++i) {
    const int j = match.second_of_first[i];
    if (j < 0) continue;
    comparison.joints.emplace_back(static_cast<int>(i), j);
    comparison.first_joint_of_second[static_cast<std::size_t>(j)] = static_cast<int>(i);
  }
}

void match_scene_meshes(SceneComparison& comparison) {
  const auto first = names_of(comparison.first.meshes);
  const auto second = names_of(comparison.second.meshes);
  if (comparison.first.only_joints != comparison.second.only_joints) {
    comparison.note(fmt::format("only the {} can have meshes, so only joints are compared",
                                comparison.first.only_joints ? "second" : "first"));
    return;
  }
  if (comparison.options.matching == Matching::nearest) {
    group_meshes(comparison);
    return;
  }
  const ListMatch match = comparison.options.matching == Matching::automatic
                              ? match_meshes(comparison)
                              : match_lists(first, second, comparison.options.matching);
  say_partners_missing(comparison, match, first, second);
  bool hint = false;
  for (const auto& [i, j] : match.pairs) {
    if (first.size() == second.size()) {
      const SceneMesh& a = comparison.first.meshes[static_cast<std::size_t>(i)];
      const SceneMesh& b = comparison.second.meshes[static_cast<std::size_t>(j)];
      if (a.name != b.name) {
        report_name(comparison, "mesh", a.name, b.name, false);
      } else {  // the nodes' names, by which they match
        report_name(comparison, "mesh", a.mesh_name, b.mesh_name,
                    comparison.options.matching == Matching::name);
      }
    }
    const std::size_t a = comparison.first.meshes[static_cast<std::size_t>(i)].vertex_count;
    const std::size_t b = comparison.second.meshes[static_cast<std::size_t>(j)].vertex_count;
    if (a != b) {
      comparison.say(fmt::format("{}: {} vertices in the first, {} in the second",
                                 label("mesh", first[static_cast<std::size_t>(i)], i), a, b));
      hint = true;
      continue;
    }
    comparison.meshes.emplace_back(i, j);
  }
  if (hint) comparison.note("--match nearest compares surfaces, whatever their vertices");
}

}  // namespace krok::compare
