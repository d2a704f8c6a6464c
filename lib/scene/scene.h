#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "math/transform.h"
#include "scene/material.h"
#include "scene/skeleton.h"

// An animated scene as it is shown and compared: its contents, and a function that evaluates it at
// any time. How it is animated (skin, morph targets, node animation, cached points) does not
// matter. Made by scene_of() of what a file holds: lib/nodes, lib/skin.

namespace krok {

// What an animation does from one of its key times to the next, for comparing it there too.
struct KeyGap {
  // Equal parts at whose ends to look: 1 if the values are straight from key to key, more for
  // cubic splines and for rotations by large angles, whose shorter way depends on rounding.
  int parts = 1;
  bool jumps = false;  // a step: a value jumps at the end

  friend bool operator==(const KeyGap&, const KeyGap&) = default;
};

// Skin influences of a mesh's vertices, shape [vertices x per_vertex].
struct SkinInfluences {
  int per_vertex = 0;
  std::span<const std::uint16_t> joints;
  std::span<const float> weights;
};

// A mesh in the scene. The spans point into memory of the creator.
struct SceneMesh {
  std::string name;  // for messages and matching; may be empty
  // As in the file, where it has them; may be empty.
  std::string node_name{}, mesh_name{};
  std::size_t vertex_count = 0;
  bool has_normals = false;
  bool has_tangents = false;
  bool only_points = false;  // the file has only positions; missing attributes are not a difference
  std::span<const std::array<std::uint32_t, 3>> triangles;
  std::span<const Vec2f> texture_coordinates;                      // [vertices] or none
  std::vector<std::span<const Vec2f>> more_texture_coordinates{};  // sets 1 and so on, or empty
  std::span<const Vec4f> colours{};  // [vertices] or none: linear red, green, blue, alpha
  // Whether a vertex is not white: white ones look as if there were none.
  bool is_painted() const {
    return std::ranges::any_of(colours, [](const Vec4f& one) { return one != Vec4f::Ones(); });
  }
  bool visible = true;

  // Displacements of a morph target, [vertices] or empty; in world space unless the scene has
  // ScenePlacement::displace.
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

  SkinInfluences influences;  // indices into Scene::joint_names; per_vertex = 0 if there are none
};

// Vertices and joints at one time, in world space, metres.
struct SceneState {
  bool joints_alone = false;  // set by the caller: the rest is not needed and left empty
  std::vector<std::vector<Vec3>> positions;  // [meshes][vertices]
  std::vector<std::vector<Vec3>>
      normals;  // [meshes][vertices], or empty for a mesh without normals
  // The same for meshes with tangents, ignored for others: xyz unit or zero, sign of w as in glTF.
  std::vector<std::vector<Vec4>> tangents;
  std::vector<Transform> joints;  // [joints]
  std::vector<Mat4> places;       // [places], node_to_world
  // Of each mesh 1, or -1 if its front faces are those wound clockwise, or 0 if it is flattened;
  // empty for 1.
  std::vector<int> windings;
};

// How meshes are placed at one time.
struct ScenePlacement {
  std::vector<int> windings;  // as SceneState::windings
  // Displacements of a morph target in world space; the spans of the result point into `memory`
  // or are those of the target. Not set if all are in world space.
  using Memory = std::array<std::vector<Vec3f>, 3>;
  std::function<SceneMesh::Target(int mesh, int target, Memory& memory)> displace{};
};

struct Scene {
  std::shared_ptr<const void> memory{};  // what the spans point into, or null if that is outside

  // Missing data that the file format cannot store is not a difference.
  bool only_joints = false;  // no meshes
  bool only_still = false;   // no animations

  std::vector<SceneMesh> meshes;
  bool knows_materials = false;            // whether a missing material means that there is none
  std::vector<std::string> joint_names;    // matched by index if names are empty or repeat
  std::vector<int> joint_parents;          // nearest ancestor that is a joint, or -1
  std::vector<std::uint8_t> joint_ends{};  // as Skeleton::end_sites, or empty for none

  // Nodes without a mesh that neither are joints nor carry any: cameras, lights, sockets, markers.
  struct Place {
    std::string name;                                // may be empty
    std::vector<MaterialParameter> parameters = {};  // of its camera and light
  };
  std::vector<Place> places{};
  // Of other parts of the file, "animation Walk, velocity".
  std::vector<MaterialParameter> properties{};
  bool knows_nodes = false;  // whether those that are missing are missing in the file

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
  std::function<ScenePlacement(int animation, double time)> place{};

  // Contents that neither evaluate() nor the meshes hold: "2 lights".
  std::vector<std::string> not_compared{};
};

// The joints in the pose without animation. Names may be empty or repeat, unlike what
// check(Skeleton) asks for.
Skeleton skeleton_of(const Scene& scene);

}  // namespace krok
