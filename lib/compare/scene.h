#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "compare/mesh_difference.h"
#include "math/transform.h"
#include "math/types.h"
#include "scene/key_gap.h"
#include "scene/material.h"
#include "scene/material_parameter.h"

// An animated scene for comparison: its contents, and a function that evaluates it at any time. How
// it is animated (skin, morph targets, node animation, cached points) does not matter.

namespace krok::compare {

// A mesh in the scene. The spans point into memory of the creator.
struct SceneMesh {
  std::string name;  // for messages and matching; may be empty
  // As in the file, where it has them; may be empty.
  std::string node_name{}, mesh_name{};
  std::size_t vertex_count = 0;
  bool has_normals = false;
  bool has_tangents = false;
  bool only_points = false;  // the file has only positions; missing attributes are not a difference
  std::span<const Triangle> triangles;
  std::span<const Vec2f> texture_coordinates;                      // [vertices] or none
  std::vector<std::span<const Vec2f>> more_texture_coordinates{};  // sets 1 and so on, or empty
  std::span<const Vec4f> colours{};  // [vertices] or none: linear red, green, blue, alpha
  // Whether a vertex is not white: white ones look as if there were none.
  bool is_painted() const {
    return std::ranges::any_of(colours, [](const Vec4f& one) { return one != Vec4f::Ones(); });
  }
  bool visible = true;

  // Displacements of a morph target, [vertices] or empty; in world space unless the scene has
  // Placement::displace.
  struct Target {
    std::string name;
    std::span<const Vec3f> positions;
    std::span<const Vec3f> normals;
    std::span<const Vec3f> tangents{};  // of the tangents' xyz
  };
  std::vector<Target> targets;
  bool animates_weights = false;  // an animation changes how much the targets add

  const Material* material = nullptr;  // null if none
  std::span<const MaterialParameter> material_parameters{};
  // Whether a texture of the material uses a set of texture coordinates.
  std::vector<bool> used_coordinates{};

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
  // Of each mesh 1, or -1 if its front faces are those wound clockwise, or 0 if it is flattened;
  // empty for 1.
  std::vector<int> windings;
};

// How meshes are placed at one time.
struct Placement {
  std::vector<int> windings;  // as SceneState::windings
  // Displacements of a morph target in world space; the spans of the result point into `memory`
  // or are those of the target. Not set if all are in world space.
  using Memory = std::array<std::vector<Vec3f>, 3>;
  std::function<SceneMesh::Target(int mesh, int target, Memory& memory)> displace{};
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
    std::vector<KeyGap> gaps{};     // [key_times - 1], or empty if all are straight
    std::string interpolation{};    // "linear and step"; empty if unknown
  };
  std::vector<Animation> animations;

  // Fills `state` for a time of an animation, or (-1) for the pose without animation. Must be
  // thread-safe with one state per thread. Never fails.
  std::function<void(int animation, double time, SceneState& state)> evaluate;
  // The same for how meshes are placed. May be empty: all face as wound, displaced in world space.
  std::function<Placement(int animation, double time)> place{};

  // Contents that neither evaluate() nor the meshes hold: "2 lights".
  std::vector<std::string> not_compared{};
};

}  // namespace krok::compare
