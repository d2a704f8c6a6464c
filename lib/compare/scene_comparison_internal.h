#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "compare/matching.h"
#include "compare/scene_difference.h"
#include "compare/surface_match_internal.h"

// Private to this folder: the steps of comparing two scenes, and what they share.

namespace krok::compare {

// One moment at which both scenes are evaluated.
struct Moment {
  int first_animation = -1;
  int second_animation = -1;
  int frame = -1;
  double first_time = 0;
  double second_time = 0;  // within the tolerance of the other
};

struct SceneComparison {
  const Scene& first;
  const Scene& second;
  const SceneOptions& options;
  SceneDifference result{};

  Pairs joints{};  // those that are compared
  std::vector<int> first_joint_of_second{};
  Pairs meshes{};                        // those whose vertices are compared by number
  std::vector<SurfaceGroup> groups{};    // those whose vertices are compared by nearest points
  std::vector<SurfaceMatch> surfaces{};  // of the groups, both ways
  std::vector<Moment> moments{};
  std::set<std::pair<const Material*, const Material*>> materials{};  // those that were compared

  void say(std::string sentence) { result.structure.push_back(std::move(sentence)); }
  void note(std::string sentence) { result.notes.push_back(std::move(sentence)); }
};

// "mesh Body", or "mesh 3" for one without a name.
std::string label(const char* kind, const std::string& name, int index);

template <typename Item>
std::vector<std::string> names_of(const std::vector<Item>& items) {
  std::vector<std::string> names;
  names.reserve(items.size());
  for (const Item& item : items) names.push_back(item.name);
  return names;
}

// Fills `joints`, and `meshes` or `groups`.
void match_scene_joints(SceneComparison& comparison);
void match_scene_meshes(SceneComparison& comparison);

// What two meshes are made of whose vertices correspond by number: triangles, texture coordinates,
// morph targets, weights, materials.
void compare_shapes(SceneComparison& comparison, int first_mesh, int second_mesh);

bool has_normal_texture(const SceneMesh& mesh);

// Says that only one has tangents: a difference where normal textures of both would show them
// (`shown`), else a note.
void report_tangents(SceneComparison& comparison, const std::string& before, bool first_has,
                     bool shown);

// Fills `moments`; code compare-too-long.
Status choose_moments(SceneComparison& comparison);

// Fills `surfaces` from `groups`; code compare-value.
Status match_surfaces(SceneComparison& comparison, int jobs);

// Evaluates both scenes at all moments; code compare-value.
Status compare_moments(SceneComparison& comparison, int jobs, Progress& progress);

}  // namespace krok::compare
