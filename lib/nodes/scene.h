#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/material.h"

// An imported scene: a tree of nodes with meshes, morph targets, skins, cameras and keyframe
// animations. Its structure is that of glTF 2.0, to which other formats are mapped. Of lights
// only their nodes are known. Indices are checked by the reader and always in range. Source:
// Khronos Group, glTF 2.0 Specification (ISO/IEC 12113).

namespace krok::nodes {

// Values of an accessor, shared by all that refer to it; null if not in the file.
template <typename T>
using Shared = std::shared_ptr<const std::vector<T>>;

struct Node {
  std::string name;  // may be empty, need not be unique
  int parent = -1;
  std::vector<int> children;
  // node_to_parent: `matrix` if the file has one, otherwise translation * rotation * scale.
  bool has_matrix = false;
  Mat4 matrix = Mat4::Identity();
  Vec3 translation = Vec3::Zero();
  Quat rotation = Quat::Identity();  // unit
  Vec3 scale = Vec3::Ones();
  // How the parent's scale reaches the node. glTF knows the first; FBX (InheritType; Autodesk, FBX
  // SDK, Transformations sample): along the node's own axes, and all but that of the parent itself,
  // as by Maya's segment scale compensation.
  enum class ParentScale : unsigned char { inherited, along_own_axes, compensated };
  ParentScale parent_scale = ParentScale::inherited;
  int mesh = -1;
  int skin = -1;
  int camera = -1;
  // EXT_mesh_gpu_instancing: children that have the mesh in its place, one for each instance.
  std::vector<int> instances{};
  std::vector<double> weights;  // morph target weights; empty: those of the mesh
  bool in_scene = false;        // part of the displayed scene
  bool visible = true;          // KHR_node_visibility of the node and of all its ancestors
  bool fixture = false;         // a light, or what a camera is aimed by: never a joint
  bool bone = false;            // the file calls it a joint, whether or not a skin has it
  std::vector<MaterialParameter> parameters{};  // of its camera and light, for comparing files
};

struct MorphTarget {
  std::string name;         // from extras.targetNames of the mesh; may be empty
  Shared<Vec3f> positions;  // displacements, [vertices] or null
  Shared<Vec3f> normals;
  Shared<Vec3f> tangents{};  // displacements of xyz; w does not change
};

struct Primitive {
  static constexpr int kMaxInfluences = 8;

  std::string material;     // name in the file; may be empty
  int material_index = -1;  // in Scene::materials; -1: none, or materials were not requested
  Shared<Vec3f> positions;  // never null
  Shared<Vec3f> normals;
  // As in glTF: xyz unit, or zero if zero in the file; w, 1 or -1, is the handedness.
  Shared<Vec4f> tangents;
  Shared<Vec2f> texture_coordinates;                    // the first set
  std::vector<Shared<Vec2f>> more_texture_coordinates;  // TEXCOORD_1 and so on, null where missing
  Shared<Vec4f> colours;                                // COLOR_0: linear red, green, blue, alpha
  // [vertices x influences_per_vertex]; joints are indices into the skin's list. 0, 4 or 8 per
  // vertex.
  int influences_per_vertex = 0;
  std::vector<std::uint16_t> influence_joints;
  std::vector<float> influence_weights;
  // Strips and fans are converted to triangles; empty for points and lines.
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

// Looks along the node's local -Z with +Y up.
struct Camera {
  std::string name;            // may be empty
  bool perspective = true;     // otherwise orthographic, without a field of view
  double field_of_view = 0.0;  // vertical, radians, in (0, pi) for a perspective camera
  // For a perspective camera with animated field of view: its values at times i / lens_rate of any
  // animation, interpolated linearly and clamped at the ends.
  double lens_rate = 0.0;     // > 0 if `lens` is not empty
  std::vector<float> lens{};  // in (0, pi)
};

// Unit and axes as specified by the file. If unset, the importer must detect them. glTF specifies
// both.
struct Space {
  std::optional<double> metres;      // per unit of length
  std::optional<Quat> file_to_krok;  // rotates to +Y up and the character facing +Z
  bool up_is_y = false;              // +Y is up for certain, the facing is not specified
};

enum class Path : unsigned char { translation, rotation, scale, weights, field_of_view };
enum class Interpolation : unsigned char { linear, step, cubic_spline };

// Keys of one property of one node. Times are strictly increasing. Values have `width` numbers per
// key (3, 4 or the number of targets), three times that for cubic splines: in-tangent, value,
// out-tangent.
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
  std::vector<Channel> channels;  // of nodes
  // Of cameras: Channel::node is an index into Scene::cameras, the path is field_of_view with width
  // 1 and values in (0, pi).
  std::vector<Channel> lenses{};
  double rate = 0;  // frames per second as the file says, not checked; 0: unknown
  // Viewers play from time 0, as glTF's do, and hold each channel's first value until its first
  // key. If not, the first key is where the animation begins.
  bool from_zero = false;
};

struct Scene {
  std::string generator;
  std::vector<Node> nodes;
  // Of the trees with nodes of the displayed scene: the default one, else the first, else all.
  std::vector<int> roots;
  std::vector<Mesh> meshes;
  std::vector<Skin> skins;
  std::vector<Camera> cameras;
  std::vector<Animation> animations;
  // With unique names, those of the file if they are unique and not empty; images include their
  // bytes. Only if requested.
  std::vector<Material> materials;
  std::vector<std::vector<MaterialParameter>> material_parameters;  // [materials]
  Space space;
  std::vector<std::string> files;  // paths of other files that were read
  // Extras of animations, nodes and meshes, and variants of materials, for comparing files:
  // "animation Walk, velocity".
  std::vector<MaterialParameter> properties;
  // What the file has beside that and evaluation does not show, with counts: "2 vertex
  // attributes of other names", "extension KHR_physics_rigid_bodies".
  std::vector<std::string> not_shown;
  Diagnostics diagnostics;  // what was ignored or is doubtful
};

// Makes material names valid (see is_name) and unique: a material without a name becomes
// "material_3" (the fourth), the second one named Skin becomes "Skin_2".
void make_names_unique(std::vector<Material>& materials);

}  // namespace krok::nodes
