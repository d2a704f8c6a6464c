#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "compare/mesh_difference.h"
#include "math/transform.h"
#include "math/types.h"
#include "scene/material.h"

// An animated scene for comparison: its contents, and a function that evaluates it at any time. How
// it is animated (skin, morph targets, node animation, cached points) does not matter.

namespace krok::compare {

// A mesh in the scene. The spans point into memory of the creator.
struct SceneMesh {
  std::string name;  // for messages and matching; may be empty
  std::size_t vertex_count = 0;
  bool has_normals = false;
  bool has_tangents = false;
  bool only_points = false;  // the file has only positions; missing attributes are not a difference
  std::span<const Triangle> triangles;
  std::span<const Vec2f> texture_coordinates;  // [vertices] or none

  // Displacements of a morph target, [vertices] or empty.
  struct Target {
    std::string name;
    std::span<const Vec3f> positions;
    std::span<const Vec3f> normals;
    std::span<const Vec3f> tangents{};  // of the tangents' xyz
  };
  std::vector<Target> targets;

  const Material* material = nullptr;  // null if none

  Influences influences;  // indices into Scene::joint_names; per_vertex = 0 if there are none
};

// Vertices and joints at one time, in world space, metres.
struct SceneState {
  std::vector<std::vector<Vec3>> positions;  // [meshes][vertices]
  std::vector<std::vector<Vec3>>
      normals;  // [meshes][vertices], or empty for a mesh without normals
  // The same for meshes with tangents, ignored for others: xyz unit or zero, sign of w as in glTF.
  std::vector<std::vector<Vec4>> tangents;
  std::vector<Transform> joints;  // [joints]
};

struct Scene {
  // Missing data that the file format cannot store is not a difference.
  bool only_joints = false;  // no meshes
  bool only_still = false;   // no animations

  std::vector<SceneMesh> meshes;
  bool knows_materials = false;          // whether a missing material means that there is none
  std::vector<std::string> joint_names;  // matched by index if names are empty or repeat
  std::vector<int> joint_parents;        // nearest ancestor that is a joint, or -1

  struct Animation {
    std::string name;
    std::vector<double> key_times;  // seconds, rising
    bool straight = true;           // linear between keys, without steps or splines
  };
  std::vector<Animation> animations;

  // Fills `state` for a time of an animation, or (-1) for the pose without animation. Must be
  // thread-safe with one state per thread. Never fails.
  std::function<void(int animation, double time, SceneState& state)> evaluate;
};

}  // namespace krok::compare
