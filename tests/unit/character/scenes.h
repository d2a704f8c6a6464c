#pragma once

#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "math/quaternion.h"
#include "nodes/evaluate.h"
#include "nodes/scene.h"

// Scenes put together by hand.

namespace krok::test {

template <typename T>
nodes::Shared<T> shared(std::vector<T> values) {
  return std::make_shared<const std::vector<T>>(std::move(values));
}

// Adds a node; returns its number.
inline int add_node(nodes::Scene& scene, std::string name, int parent,
                    const Vec3& translation = Vec3::Zero(), const Quat& rotation = Quat::Identity(),
                    double scale = 1.0) {
  const int index = static_cast<int>(scene.nodes.size());
  nodes::Node node;
  node.name = std::move(name);
  node.parent = parent;
  node.translation = translation;
  node.rotation = rotation;
  node.scale = Vec3::Constant(scale);
  node.in_scene = true;
  scene.nodes.push_back(std::move(node));
  if (parent < 0) {
    scene.roots.push_back(index);
  } else {
    scene.nodes[static_cast<std::size_t>(parent)].children.push_back(index);
  }
  return index;
}

// A skin of these joints whose bind pose is as the nodes stand, seen from `mesh_to_world`.
inline int add_skin(nodes::Scene& scene, std::string name, std::vector<int> joints,
                    const Mat4& mesh_to_world = Mat4::Identity()) {
  const auto evaluator = nodes::Evaluator::create(scene);
  nodes::Evaluation rest;
  evaluator->place_nodes(-1, 0, rest);
  nodes::Skin skin;
  skin.name = std::move(name);
  skin.joints = std::move(joints);
  for (const int joint : skin.joints) {
    const Mat4& to_world = rest.node_to_world[static_cast<std::size_t>(joint)];
    skin.inverse_binds.push_back(to_world.inverse() * mesh_to_world);
  }
  scene.skins.push_back(std::move(skin));
  return static_cast<int>(scene.skins.size()) - 1;
}

// A node with a mesh of a few triangles whose vertices hang on up to four of the skin's joints; on
// the node itself for skin -1.
inline int add_mesh(nodes::Scene& scene, std::string name, int parent, int skin, unsigned seed = 1,
                    int vertices = 12) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<float>(random() % 2001) / 1000.0f - 1.0f; };
  nodes::Primitive shape;
  std::vector<Vec3f> positions, normals;
  const std::size_t joints =
      skin < 0 ? 0 : scene.skins[static_cast<std::size_t>(skin)].joints.size();
  if (skin >= 0) shape.influences_per_vertex = 4;
  for (int v = 0; v < vertices; ++v) {
    positions.emplace_back(number(), number(), number());
    normals.push_back((Vec3f(number(), number(), number()) + Vec3f(0, 3, 0)).normalized());
    float left = 1;
    for (int k = 0; k < shape.influences_per_vertex; ++k) {
      const float weight = k == 3 ? left : 0.5f * left;
      left -= weight;
      shape.influence_joints.push_back(static_cast<std::uint16_t>(random() % joints));
      shape.influence_weights.push_back(weight);
    }
  }
  for (std::uint32_t v = 0; v + 2 < static_cast<std::uint32_t>(vertices); ++v) {
    shape.triangles.push_back({v, v + 1, v + 2});
  }
  shape.positions = shared(std::move(positions));
  shape.normals = shared(std::move(normals));
  nodes::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(std::move(shape));
  scene.meshes.push_back(std::move(mesh));
  const int node = add_node(scene, std::move(name), parent);
  scene.nodes[static_cast<std::size_t>(node)].mesh = static_cast<int>(scene.meshes.size()) - 1;
  scene.nodes[static_cast<std::size_t>(node)].skin = skin;
  return node;
}

inline void add_channel(nodes::Animation& animation, int node, nodes::Path path, int width,
                        std::vector<float> times, std::vector<float> values) {
  nodes::Channel channel;
  channel.node = node;
  channel.path = path;
  channel.width = width;
  channel.times = shared(std::move(times));
  channel.values = shared(std::move(values));
  animation.channels.push_back(std::move(channel));
}

// Times 0, 1/rate, 2/rate, ...
inline std::vector<float> even_times(int count, double rate, double first = 0) {
  std::vector<float> times;
  for (int i = 0; i < count; ++i) times.push_back(static_cast<float>(first + i / rate));
  return times;
}

// Turns about an axis that swing with time.
inline std::vector<float> swing(const std::vector<float>& times, const Vec3& axis, double size) {
  std::vector<float> values;
  for (const float time : times) {
    const Quat q = from_rotation_vector(axis.normalized() * size * std::sin(5.0 * time));
    for (const double value : {q.x(), q.y(), q.z(), q.w()}) {
      values.push_back(static_cast<float>(value));
    }
  }
  return values;
}

// An armature with a scale of 0.01 and a turn, a chain of three bones in centimetres, a mesh on
// them, and a motion of 13 frames at 24 a second that begins with the second one.
inline nodes::Scene armature_scene() {
  nodes::Scene scene;
  scene.space = {1.0, Quat::Identity()};
  const int armature = add_node(scene, "Armature", -1, Vec3(0.2, 0.1, 0),
                                from_rotation_vector(Vec3(-kPi / 2, 0, 0)), 0.01);
  const int hips =
      add_node(scene, "Hips", armature, Vec3(0, 0, 90), from_rotation_vector(Vec3(0.1, 0.2, 0.3)));
  const int spine =
      add_node(scene, "Spine", hips, Vec3(0, 30, 0), from_rotation_vector(Vec3(0.2, -0.1, 0)));
  const int head = add_node(scene, "Head", spine, Vec3(0, 25, 3));
  add_node(scene, "Head_end", head, Vec3(0, 20, 0));
  Mat4 mesh_to_world = Mat4::Identity();
  mesh_to_world.topLeftCorner<3, 3>() *= 0.5;
  const int skin = add_skin(scene, "Body", {hips, spine, head}, mesh_to_world);
  add_mesh(scene, "Body", -1, skin);
  nodes::Animation walk;
  walk.name = "Walk";
  const auto times = even_times(13, 24, 1 / 24.0);
  add_channel(walk, hips, nodes::Path::rotation, 4, times, swing(times, Vec3(1, 0.3, 0), 0.7));
  add_channel(walk, spine, nodes::Path::rotation, 4, times, swing(times, Vec3(0, 1, 0.4), -0.9));
  std::vector<float> places;
  for (const float time : times) places.insert(places.end(), {10 * time, 0, 90 + 3 * time});
  add_channel(walk, hips, nodes::Path::translation, 3, times, places);
  scene.animations.push_back(std::move(walk));
  return scene;
}

inline bool has_code(const Diagnostics& diagnostics, const std::string& code) {
  for (const Diagnostic& one : diagnostics) {
    if (one.code == code) return true;
  }
  return false;
}

}  // namespace krok::test
