#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "compare/mesh_difference.h"
#include "core/progress.h"
#include "core/result.h"
#include "math/transform.h"

// Comparing two animated scenes by what a viewer shows: both are evaluated at the same moments, and
// vertices and joints compared in world space. How a scene is animated (a skin, morph targets,
// nodes that move) does not matter; so a rig can be held against the same motion baked into morph
// targets.

namespace krok::compare {

// A mesh as it stands in the scene. The spans belong to whoever made the description.
struct SceneMesh {
  std::string name;  // for people and for matching; may be empty
  std::size_t vertex_count = 0;
  bool has_normals = false;
  std::span<const Triangle> triangles;
  std::span<const Vec2f> texture_coordinates;  // [vertices] or none

  // Displacements of a shape, [vertices] or none.
  struct Target {
    std::string name;
    std::span<const Vec3f> positions;
    std::span<const Vec3f> normals;
  };
  std::vector<Target> targets;

  Influences influences;  // joints are indices into Scene::joint_names; none: per_vertex = 0
};

// Vertices and joints at one moment, in world space, metres.
struct SceneState {
  std::vector<std::vector<Vec3>> positions;  // [meshes][vertices]
  std::vector<std::vector<Vec3>> normals;    // [meshes][vertices], or none for a mesh without
  std::vector<Transform> joints;             // [joints]
};

struct Scene {
  std::vector<SceneMesh> meshes;
  std::vector<std::string> joint_names;  // may be empty or repeat; then places decide
  std::vector<int> joint_parents;        // the nearest ancestor that is a joint, or -1

  struct Animation {
    std::string name;
    std::vector<double> key_times;  // seconds, rising
  };
  std::vector<Animation> animations;

  // Fills `state` for a moment of an animation, or (-1) for the pose without any. Called from many
  // threads at once, each with a state of its own. Never fails.
  std::function<void(int animation, double time, SceneState& state)> evaluate;
};

struct SceneDifference {
  // What keeps the two from being the same whatever the tolerance: meshes, vertices, triangles,
  // joints or animations that do not correspond. Sentences for people. What can be measured all the
  // same, is.
  std::vector<std::string> structure;
  // What differs but is no fault: joints that only one has where the other is baked, key times.
  std::vector<std::string> notes;

  int compared_times = 0;  // moments at which both were evaluated, of all animations together
  Measure positions;       // metres, world space
  Measure normals;         // radians, world space
  Measure joint_positions, joint_orientations;
  Measure target_positions;     // metres: displacements by morph targets, where both have them
  Measure target_normals;       // length of the difference of normals' displacements, no unit
  Measure texture_coordinates;  // the larger of u and v
  Measure weights;              // of skins, where both have one

  bool same() const;
};

// Meshes are matched by name where all names of both are unique and the same, otherwise by place;
// joints and animations too. Each pair of animations is compared at the key times of both (times
// within 0.1 ms are one) as far as both last; without animations the pose without any is compared.
// A scene whose meshes are skinned may be held against one without joints: joints are then not
// compared. An Error (code compare-value) if a scene gives values that are not finite, (code
// compare-too-long) for more than a million moments. Deterministic for any number of jobs.
Result<SceneDifference> difference(const Scene& first, const Scene& second,
                                   const Tolerance& tolerance, int jobs, Progress& progress);

}  // namespace krok::compare
