#include "tools/krok-diff/gltf_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "core/numbers.h"
#include "nodes/evaluate.h"
#include "nodes/key_gaps.h"

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

// What is compared of an instance and not stored in the file as such.
struct MeshMemory {
  std::vector<std::uint16_t> scene_joints;  // of the influences, indices in the scene's list
  std::vector<Vec2f> coordinates;           // texture coordinates as the textures use them
  std::vector<MaterialParameter> parameters;
};

constexpr std::string_view kTransform = ", KHR_texture_transform, ";
constexpr std::string_view kSet = ", set";

// A texture transform; the values of the file, or those of none.
struct Coordinates {
  std::vector<double> offset{0, 0}, scale{1, 1}, rotation{0};

  friend bool operator==(const Coordinates&, const Coordinates&) = default;

  // Source: KHR_texture_transform.
  Vec2f at(const Vec2f& place) const {
    const double c = std::cos(rotation[0]), s = std::sin(rotation[0]);
    const double u = scale[0] * static_cast<double>(place.x());
    const double v = scale[1] * static_cast<double>(place.y());
    return Vec2(offset[0] + c * u + s * v, offset[1] - s * u + c * v).cast<float>();
  }
};

// How each texture of a material uses texture coordinates.
struct TextureUses {
  std::map<std::string, Coordinates, std::less<>> transforms;  // of textures of the first set
  std::vector<bool> sets;                                      // whether one uses it
};

TextureUses uses_of(const Material& material, std::span<const MaterialParameter> parameters) {
  TextureUses uses;
  constexpr std::array kNames = {"baseColorTexture", "metallicRoughnessTexture", "normalTexture",
                                 "occlusionTexture", "emissiveTexture"};
  const auto textures = textures_of(material);
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (*textures[i]) uses.transforms[kNames[i]];
  }
  for (const MaterialParameter& one : parameters) {
    if (one.texture) uses.transforms[one.name];
  }
  uses.sets.assign(1, !uses.transforms.empty());
  for (const MaterialParameter& one : parameters) {
    if (!one.name.ends_with(kSet) || one.values.size() != 1) continue;
    uses.transforms.erase(one.name.substr(0, one.name.size() - kSet.size()));
    const double set = one.values[0];
    if (!(set >= 0 && set < 16)) continue;
    uses.sets.resize(std::max(uses.sets.size(), static_cast<std::size_t>(set) + 1));
    uses.sets[static_cast<std::size_t>(set)] = true;
  }
  for (const MaterialParameter& one : parameters) {
    const std::size_t at = one.name.find(kTransform);
    if (at == std::string::npos) continue;
    const auto texture = uses.transforms.find(one.name.substr(0, at));
    if (texture == uses.transforms.end()) continue;
    const std::string_view key = std::string_view(one.name).substr(at + kTransform.size());
    for (const auto& [name, values] : {std::pair("offset", &texture->second.offset),
                                       {"scale", &texture->second.scale},
                                       {"rotation", &texture->second.rotation}}) {
      if (key == name && one.values.size() == values->size()) *values = one.values;
    }
  }
  return uses;
}

// Where all textures of a material transform the first texture coordinates alike, the transformed
// ones are compared, and the transform is no difference: optimisers trade one for the other.
void apply_transform(const TextureUses& uses, const nodes::Primitive& primitive,
                     MeshMemory& memory) {
  if (uses.transforms.empty() || primitive.texture_coordinates == nullptr) return;
  const Coordinates& first = uses.transforms.begin()->second;
  const bool alike =
      std::ranges::all_of(uses.transforms, [&](const auto& one) { return one.second == first; });
  if (!alike || first == Coordinates()) return;
  for (const Vec2f& place : *primitive.texture_coordinates) {
    memory.coordinates.push_back(first.at(place));
  }
  std::erase_if(memory.parameters, [&](const MaterialParameter& one) {
    const std::size_t at = one.name.find(kTransform);
    return at != std::string::npos && uses.transforms.contains(one.name.substr(0, at));
  });
}

void add_material(const nodes::Scene& asset, const nodes::Primitive& primitive, MeshMemory& memory,
                  compare::SceneMesh& mesh) {
  if (primitive.material_index < 0) return;
  const auto index = static_cast<std::size_t>(primitive.material_index);
  mesh.material = &asset.materials[index];
  if (index < asset.material_parameters.size()) {
    memory.parameters = asset.material_parameters[index];
  }
  const TextureUses uses = uses_of(*mesh.material, memory.parameters);
  mesh.used_coordinates = uses.sets;
  apply_transform(uses, primitive, memory);
  mesh.material_parameters = memory.parameters;
  if (!memory.coordinates.empty()) mesh.texture_coordinates = memory.coordinates;
}

bool animates_weights(const nodes::Scene& asset, int node) {
  return std::ranges::any_of(asset.animations, [&](const nodes::Animation& animation) {
    return std::ranges::any_of(animation.channels, [&](const nodes::Channel& channel) {
      return channel.node == node && channel.path == nodes::Path::weights &&
             channel.times->size() > 1;
    });
  });
}

compare::SceneMesh mesh_of(const nodes::Scene& asset, const nodes::Instance& instance,
                           const nodes::Primitive& primitive,
                           const std::vector<int>& scene_joint_of_node, MeshMemory& memory) {
  const nodes::Node& node = asset.nodes[static_cast<std::size_t>(instance.node)];
  compare::SceneMesh mesh;
  mesh.name = name_of(asset, instance);
  mesh.node_name = node.name;
  mesh.mesh_name = asset.meshes[static_cast<std::size_t>(instance.mesh)].name;
  mesh.vertex_count = primitive.vertex_count();
  mesh.has_normals = primitive.normals != nullptr;
  mesh.has_tangents = primitive.tangents != nullptr;
  mesh.triangles = primitive.triangles;
  mesh.texture_coordinates = view(primitive.texture_coordinates);
  for (const auto& set : primitive.more_texture_coordinates) {
    mesh.more_texture_coordinates.push_back(view(set));
  }
  mesh.colours = view(primitive.colours);
  mesh.visible = node.visible;
  for (const nodes::MorphTarget& target : primitive.targets) {
    mesh.targets.push_back(
        {target.name, view(target.positions), view(target.normals), view(target.tangents)});
  }
  mesh.animates_weights = !mesh.targets.empty() && animates_weights(asset, instance.node);
  add_material(asset, primitive, memory, mesh);
  if (node.skin >= 0 && primitive.influences_per_vertex > 0) {
    const auto& joints = asset.skins[static_cast<std::size_t>(node.skin)].joints;
    for (const std::uint16_t joint : primitive.influence_joints) {
      const auto index = static_cast<std::size_t>(joints[joint]);
      memory.scene_joints.push_back(static_cast<std::uint16_t>(scene_joint_of_node[index]));
    }
    mesh.influences = {primitive.influences_per_vertex, memory.scene_joints,
                       primitive.influence_weights};
  }
  return mesh;
}

// The state of the scene's functions.
struct Player {
  const nodes::Scene* asset;
  nodes::Evaluator evaluator;
  std::vector<MeshMemory> memory;  // [instances]

  std::vector<int> windings(const nodes::Evaluation& moment) const {
    std::vector<int> windings;
    for (const nodes::Instance& instance : evaluator.instances()) {
      windings.push_back(evaluator.winding(instance, moment));
    }
    return windings;
  }

  compare::SceneMesh::Target displace(const nodes::Evaluation& moment, int mesh, int target,
                                      compare::Placement::Memory& room) const {
    const nodes::Instance& instance = evaluator.instances()[static_cast<std::size_t>(mesh)];
    const auto index = static_cast<std::size_t>(target);
    const nodes::MorphTarget& own = evaluator.primitive(instance).targets[index];
    nodes::Displacements world;
    if (!evaluator.displace(instance, index, moment, world)) {
      return {own.name, view(own.positions), view(own.normals), view(own.tangents)};
    }
    room = {std::move(world.positions), std::move(world.normals), std::move(world.tangents)};
    return {own.name, room[0], room[1], room[2]};
  }

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
    state.windings = windings(evaluation);
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

  player->memory.resize(from.instances().size());
  for (std::size_t i = 0; i < from.instances().size(); ++i) {
    const nodes::Instance& instance = from.instances()[i];
    scene.meshes.push_back(
        mesh_of(asset, instance, from.primitive(instance), scene_joint_of_node, player->memory[i]));
  }
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    const auto times = from.key_times(static_cast<int>(i));
    scene.animations.push_back({asset.animations[i].name, times,
                                nodes::key_gaps(asset.animations[i], times),
                                nodes::interpolation_words(asset.animations[i])});
  }
  scene.not_compared = asset.not_shown;
  scene.place = [player](int animation, double time) {
    const auto moment = std::make_shared<nodes::Evaluation>();
    player->evaluator.place_nodes(animation, time, *moment);
    compare::Placement placement;
    placement.windings = player->windings(*moment);
    placement.displace = [player, moment](int mesh, int target,
                                          compare::Placement::Memory& memory) {
      return player->displace(*moment, mesh, target, memory);
    };
    return placement;
  };
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
