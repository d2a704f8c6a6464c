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

// An animated scene as a comparison sees it: what it has, and how to get it at any moment. How it
// is animated (a skin, morph targets, nodes that move, frames of points) does not matter.

namespace krok::compare {

// A mesh as it stands in the scene. The spans belong to whoever made the description.
struct SceneMesh {
  std::string name;  // for people and for matching; may be empty
  std::size_t vertex_count = 0;
  bool has_normals = false;
  bool has_tangents = false;
  bool only_points = false;  // the file tells positions alone: that the rest lacks is no difference
  std::span<const Triangle> triangles;
  std::span<const Vec2f> texture_coordinates;  // [vertices] or none

  // Displacements of a shape, [vertices] or none.
  struct Target {
    std::string name;
    std::span<const Vec3f> positions;
    std::span<const Vec3f> normals;
    std::span<const Vec3f> tangents{};  // of their xyz
  };
  std::vector<Target> targets;

  const Material* material = nullptr;  // null: none

  Influences influences;  // joints are indices into Scene::joint_names; none: per_vertex = 0
};

// Vertices and joints at one moment, in world space, metres.
struct SceneState {
  std::vector<std::vector<Vec3>> positions;  // [meshes][vertices]
  std::vector<std::vector<Vec3>> normals;    // [meshes][vertices], or none for a mesh without
  // The same of meshes that have them, others are not looked at: xyz unit or zero, the sign of w is
  // glTF's handedness.
  std::vector<std::vector<Vec4>> tangents;
  std::vector<Transform> joints;  // [joints]
};

struct Scene {
  // What the file's format cannot hold is no difference where the other has it.
  bool only_joints = false;  // no meshes
  bool only_still = false;   // no animations

  std::vector<SceneMesh> meshes;
  bool knows_materials = false;          // whether a mesh without one has none
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

}  // namespace krok::compare
