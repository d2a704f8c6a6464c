#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "math/types.h"
#include "scene/material.h"

// A character file as other programs write it: a tree of nodes with meshes, morph targets, skins,
// cameras, and animations whose keys are at times of their own. It has the shape of glTF 2.0, into
// which the other formats fit too. Lights are left aside.
// Indices between the parts are checked by the reader and always in range.
// Source: Khronos Group, glTF 2.0 Specification (ISO/IEC 12113).

namespace krok::nodes {

// Values of an accessor, shared by all that refer to it; null where the file has none.
template <typename T>
using Shared = std::shared_ptr<const std::vector<T>>;

struct Node {
  std::string name;  // may be empty, need not be unique
  int parent = -1;
  std::vector<int> children;
  // node_to_parent: `matrix` where the file gives one, otherwise translation * rotation * scale.
  bool has_matrix = false;
  Mat4 matrix = Mat4::Identity();
  Vec3 translation = Vec3::Zero();
  Quat rotation = Quat::Identity();  // unit
  Vec3 scale = Vec3::Ones();
  int mesh = -1;
  int skin = -1;
  int camera = -1;
  std::vector<double> weights;  // of the mesh's targets; empty: the mesh's own
  bool in_scene = false;        // reached from the scene that is shown
};

struct MorphTarget {
  std::string name;  // from the mesh's extras.targetNames, where exporters put it; may be empty
  Shared<Vec3f> positions;  // displacements, [vertices] or null
  Shared<Vec3f> normals;
  Shared<Vec3f> tangents{};  // of their xyz; w never changes
};

struct Primitive {
  static constexpr int kMaxInfluences = 8;

  std::string material;     // its name as the file has it; may be empty
  int material_index = -1;  // in Scene::materials; -1: none, or materials were not asked for
  Shared<Vec3f> positions;  // never null
  Shared<Vec3f> normals;
  // As glTF has them: xyz unit, or zero where the file's is; w, 1 or -1, is the third axis' side.
  Shared<Vec4f> tangents;
  Shared<Vec2f> texture_coordinates;  // the first set
  // [vertices x influences_per_vertex]; joints are places in the skin's list. 0, 4 or 8 a vertex.
  int influences_per_vertex = 0;
  std::vector<std::uint16_t> influence_joints;
  std::vector<float> influence_weights;
  // Strips and fans are written out; none for points and lines.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<MorphTarget> targets;

  std::size_t vertex_count() const { return positions->size(); }
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;  // all with the same number of targets
  std::vector<double> weights;        // [targets]

  std::size_t target_count() const { return primitives.empty() ? 0 : primitives[0].targets.size(); }
};

struct Skin {
  std::string name;
  std::vector<int> joints;          // nodes
  std::vector<Mat4> inverse_binds;  // mesh_to_joint in the bind pose, [joints]
};

// Looks along its node's -Z with +Y up.
struct Camera {
  std::string name;            // may be empty
  bool perspective = true;     // otherwise orthographic, without a field of view
  double field_of_view = 0.0;  // vertical, radians, in (0, pi) for a perspective camera
  // Of a perspective camera whose field of view changes over time: what it is at the times
  // i / lens_rate of any animation, linear between them, before and after that the first and last.
  double lens_rate = 0.0;     // > 0 where there is any
  std::vector<float> lens{};  // in (0, pi)
};

// What a file says of the space its nodes are in. Where it says nothing, whoever imports it must
// find out. glTF prescribes both.
struct Space {
  std::optional<double> metres;      // that one unit of length has
  std::optional<Quat> file_to_krok;  // turns its axes to +Y up and the figure facing +Z
};

enum class Path : unsigned char { translation, rotation, scale, weights };
enum class Interpolation : unsigned char { linear, step, cubic_spline };

// Keys of one property of one node. Times rise strictly. Values have `width` numbers a key (3, 4 or
// the number of targets), for cubic splines three times: in-tangent, value, out-tangent.
struct Channel {
  int node = 0;
  Path path = Path::translation;
  Interpolation interpolation = Interpolation::linear;
  int width = 3;
  Shared<float> times;
  Shared<float> values;
};

struct Animation {
  std::string name;
  std::vector<Channel> channels;
};

struct Scene {
  std::string generator;
  std::vector<Node> nodes;
  std::vector<int> roots;  // of the scene that is shown: the default one, else the first, else all
  std::vector<Mesh> meshes;
  std::vector<Skin> skins;
  std::vector<Camera> cameras;
  std::vector<Animation> animations;
  // With names of their own, which are the file's where those are unique and not empty; pictures
  // with their bytes. Only where they were asked for.
  std::vector<Material> materials;
  Space space;
  std::vector<std::string> files;  // paths of those that were read besides the one asked for
  Diagnostics diagnostics;         // what was left aside or is doubtful
};

}  // namespace krok::nodes
