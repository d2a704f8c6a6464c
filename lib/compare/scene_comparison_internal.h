#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "compare/matching.h"
#include "compare/scene_difference.h"
#include "compare/surface_match_internal.h"

// Private to this folder: the steps of comparing two scenes, and their shared data.

namespace krok::compare {

// A time at which both scenes are evaluated.
struct Moment {
  int first_animation = -1;
  int second_animation = -1;
  int frame = -1;            // the first's last key time up to here
  bool after_frame = false;  // it is earlier
  double first_time = 0;
  double second_time = 0;  // equal to first_time within the tolerance
};

// A scene with the texture coordinates that its textures see: a transform that all textures of a
// material apply to the first set is applied, and no parameter of the material.
class UsedTextures {
 public:
  struct Memory {
    std::vector<Vec2f> coordinates;
    std::vector<MaterialParameter> parameters;
    std::vector<bool> used_sets;  // of texture coordinates, whether a texture uses it
  };

  explicit UsedTextures(const Scene& from);
  UsedTextures(const UsedTextures&) = delete;
  UsedTextures& operator=(const UsedTextures&) = delete;

  bool uses(int mesh, std::size_t set) const {
    const auto& sets = memory_[static_cast<std::size_t>(mesh)].used_sets;
    return set < sets.size() && sets[set];
  }

  Scene scene;

 private:
  std::vector<Memory> memory_;  // [meshes]
};

struct SceneComparison {
  const UsedTextures& first_textures;
  const UsedTextures& second_textures;
  const Scene& first;
  const Scene& second;
  const SceneOptions& options;
  SceneDifference result{};

  Pairs joints{};  // joints to compare
  std::vector<int> first_joint_of_second{};
  Pairs meshes{};                        // meshes with vertices compared by index
  std::vector<SurfaceGroup> groups{};    // meshes compared by nearest points
  std::vector<SurfaceMatch> surfaces{};  // of the groups, in both directions
  std::vector<Moment> moments{};
  int turning_gaps = 0;  // between keys, not compared: rotations there depend on the kind of file
  ScenePlacement first_placement{}, second_placement{};               // at the first of the moments
  std::set<std::pair<const Material*, const Material*>> materials{};  // already compared

  void say(std::string sentence) { result.structure.push_back(std::move(sentence)); }
  void note(std::string sentence) { result.notes.push_back(std::move(sentence)); }
  void report(std::string sentence, bool counts) {
    (counts ? result.structure : result.notes).push_back(std::move(sentence));
  }
};

// "mesh Body", or "mesh 3" if it has no name.
std::string label(const char* kind, const std::string& name, int index);

// Reports that a pair has two names, by which engines look things up: a difference if it `counts`,
// else a note. A file without names is not compared by them.
void report_name(SceneComparison& comparison, const char* kind, const std::string& first,
                 const std::string& second, bool counts);

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

// Compares static data of `meshes`: triangles, texture coordinates, colours, morph targets,
// weights, materials.
void compare_shapes(SceneComparison& comparison);

// Reports what differs in the materials of two meshes, once for each pair of materials.
void compare_materials(SceneComparison& comparison, const SceneMesh& first, const SceneMesh& second,
                       const std::string& name);

// A number for each mesh of a scene; those that are not given are 1.
int winding_of(const std::vector<int>& windings, int mesh);

bool has_normal_texture(const SceneMesh& mesh);

// Reports that only one has tangents: a difference if both have normal textures that use them
// (`shown`), else a note.
void report_tangents(SceneComparison& comparison, const std::string& before, bool first_has,
                     bool shown);

// Fills `moments`. Code: compare-too-long.
Status choose_moments(SceneComparison& comparison);

// Reports what differs at rest where both have animations, which show none of it.
void compare_rest_pose(SceneComparison& comparison);

// Compares the nodes without a mesh at all moments, and the files' other properties.
void compare_places(SceneComparison& comparison);

// Fills `surfaces` from `groups`. Code: compare-value.
Status match_surfaces(SceneComparison& comparison, int jobs);

// Evaluates both scenes at all moments. Code: compare-value.
Status compare_moments(SceneComparison& comparison, int jobs, Progress& progress);

}  // namespace krok::compare
