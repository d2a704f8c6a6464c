#include "tools/krok-diff/gltf_scene.h"

#include <fmt/format.h>
#include <algorithm>

#include "core/numbers.h"
#include "nodes/evaluate.h"

namespace krok::cli::diff {

namespace {

template <typename T>
std::span<const T> view(const nodes::Shared<T>& values) {
  return values ? std::span<const T>(*values) : std::span<const T>();
}

// Display name of the mesh: the node's name, or else the mesh's; with the primitive index if there
// are several.
std::string name_of(const nodes::Scene& asset, const nodes::Instance& instance) {
  const nodes::Node& node = asset.nodes[static_cast<std::size_t>(instance.node)];
  const nodes::Mesh& mesh = asset.meshes[static_cast<std::size_t>(instance.mesh)];
  std::string name = node.name.empty() ? mesh.name : node.name;
  if (mesh.primitives.size() > 1) {
    name += fmt::format("{}primitive {}", name.empty() ? "" : ", ", instance.primitive);
  }
  return name;
}

// The scene's mesh; `joint_of_skin` receives the influences' joints as indices in the scene's list.
compare::SceneMesh mesh_of(const nodes::Scene& asset, const nodes::Instance& instance,
                           const nodes::Primitive& primitive,
                           const std::vector<int>& scene_joint_of_node,
                           std::vector<std::uint16_t>& scene_joints) {
  compare::SceneMesh mesh;
  mesh.name = name_of(asset, instance);
  mesh.vertex_count = primitive.vertex_count();
  mesh.has_normals = primitive.normals != nullptr;
  mesh.has_tangents = primitive.tangents != nullptr;
  mesh.triangles = primitive.triangles;
  mesh.texture_coordinates = view(primitive.texture_coordinates);
  for (const nodes::MorphTarget& target : primitive.targets) {
    mesh.targets.push_back(
        {target.name, view(target.positions), view(target.normals), view(target.tangents)});
  }
  if (primitive.material_index >= 0) {
    mesh.material = &asset.materials[static_cast<std::size_t>(primitive.material_index)];
  }
  const int skin = asset.nodes[static_cast<std::size_t>(instance.node)].skin;
  if (skin >= 0 && primitive.influences_per_vertex > 0) {
    const auto& joints = asset.skins[static_cast<std::size_t>(skin)].joints;
    for (const std::uint16_t joint : primitive.influence_joints) {
      const auto node = static_cast<std::size_t>(joints[joint]);
      scene_joints.push_back(static_cast<std::uint16_t>(scene_joint_of_node[node]));
    }
    mesh.influences = {primitive.influences_per_vertex, scene_joints, primitive.influence_weights};
  }
  return mesh;
}

// The state of the scene's evaluate function.
struct Player {
  const nodes::Scene* asset;
  nodes::Evaluator evaluator;
  std::vector<std::vector<std::uint16_t>> scene_joints;  // [instances]

  void evaluate(int animation, double time, compare::SceneState& state) const {
    // Swap the vertex arrays to reuse their memory.
    nodes::Evaluation evaluation;
    evaluation.positions = std::move(state.positions);
    evaluation.normals = std::move(state.normals);
    evaluation.tangents = std::move(state.tangents);
    evaluation.with_tangents = true;
    evaluator.evaluate(animation, time, evaluation);
    state.positions = std::move(evaluation.positions);
    state.normals = std::move(evaluation.normals);
    state.tangents = std::move(evaluation.tangents);
    state.joints.clear();
    for (const int joint : evaluator.joints()) {
      state.joints.push_back(
          nodes::rigid_part(evaluation.node_to_world[static_cast<std::size_t>(joint)]));
    }
  }
};

}  // namespace

Result<compare::Scene> scene_of(const nodes::Scene& asset) {
  auto evaluator = nodes::Evaluator::create(asset);
  if (!evaluator) return evaluator.error();
  const auto player = std::make_shared<Player>(Player{&asset, std::move(*evaluator), {}});
  const nodes::Evaluator& from = player->evaluator;

  compare::Scene scene;
  scene.knows_materials = true;
  std::vector<int> scene_joint_of_node(asset.nodes.size(), -1);
  for (std::size_t i = 0; i < from.joints().size(); ++i) {
    const auto node = static_cast<std::size_t>(from.joints()[i]);
    scene_joint_of_node[node] = static_cast<int>(i);
    scene.joint_names.push_back(asset.nodes[node].name);
  }
  scene.joint_parents = from.joint_parents();
  if (from.joints().size() > 0xFFFF) {
    return Error("gltf-too-large", fmt::format("{} joints exceed the limit", from.joints().size()));
  }

  player->scene_joints.resize(from.instances().size());
  for (std::size_t i = 0; i < from.instances().size(); ++i) {
    const nodes::Instance& instance = from.instances()[i];
    scene.meshes.push_back(mesh_of(asset, instance, from.primitive(instance), scene_joint_of_node,
                                   player->scene_joints[i]));
  }
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    const bool straight =
        std::ranges::all_of(asset.animations[i].channels, [](const nodes::Channel& channel) {
          return channel.interpolation == nodes::Interpolation::linear || channel.times->size() < 2;
        });
    scene.animations.push_back(
        {asset.animations[i].name, from.key_times(static_cast<int>(i)), straight});
  }
  scene.evaluate = [player](int animation, double time, compare::SceneState& state) {
    player->evaluate(animation, time, state);
  };
  return scene;
}

std::string summary_of(const compare::Scene& scene) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const compare::SceneMesh& mesh : scene.meshes) {
    vertices += mesh.vertex_count;
    triangles += mesh.triangles.size();
  }
  const auto number = [](std::size_t count) { return static_cast<std::int64_t>(count); };
  return fmt::format("{}, {}, {}; {}; {}", counted(number(scene.meshes.size()), "mesh", "meshes"),
                     counted(number(vertices), "vertex", "vertices"),
                     counted(number(triangles), "triangle", "triangles"),
                     counted(number(scene.joint_names.size()), "joint", "joints"),
                     counted(number(scene.animations.size()), "animation", "animations"));
}

}  // namespace krok::cli::diff
