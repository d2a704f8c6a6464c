#include "nodes/scene_of.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "core/text.h"

namespace krok::nodes {

namespace {

template <typename T>
std::span<const T> view(const Shared<T>& values) {
  return values ? std::span<const T>(*values) : std::span<const T>();
}

// Display name of the mesh: the node's name, or else the mesh's; with the primitive index if there
// are several.
std::string name_of(const Scene& asset, const Instance& instance) {
  const Node& node = asset.nodes[static_cast<std::size_t>(instance.node)];
  const Mesh& mesh = asset.meshes[static_cast<std::size_t>(instance.mesh)];
  std::string name = node.name.empty() ? mesh.name : node.name;
  if (mesh.primitives.size() > 1) {
    name += fmt::format("{}primitive {}", name.empty() ? "" : ", ", instance.primitive);
  }
  return name;
}

bool animates_weights(const Scene& asset, int node) {
  return std::ranges::any_of(asset.animations, [&](const Animation& animation) {
    return std::ranges::any_of(animation.channels, [&](const Channel& channel) {
      return channel.node == node && channel.path == Path::weights && channel.times->size() > 1;
    });
  });
}

SceneMesh mesh_of(const Scene& asset, const Instance& instance, const Primitive& primitive,
                  const std::vector<int>& scene_joint_of_node,
                  std::vector<std::uint16_t>& joints_of_influences) {
  const Node& node = asset.nodes[static_cast<std::size_t>(instance.node)];
  SceneMesh mesh;
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
  for (const MorphTarget& target : primitive.targets) {
    mesh.targets.push_back(
        {target.name, view(target.positions), view(target.normals), view(target.tangents)});
  }
  mesh.animates_weights = !mesh.targets.empty() && animates_weights(asset, instance.node);
  if (primitive.material_index >= 0) {
    const auto index = static_cast<std::size_t>(primitive.material_index);
    mesh.material = &asset.materials[index];
    if (index < asset.material_parameters.size()) {
      mesh.material_parameters = asset.material_parameters[index];
    }
  }
  if (node.skin >= 0 && primitive.influences_per_vertex > 0) {
    const auto& joints = asset.skins[static_cast<std::size_t>(node.skin)].joints;
    for (const std::uint16_t joint : primitive.influence_joints) {
      const auto index = static_cast<std::size_t>(joints[joint]);
      joints_of_influences.push_back(static_cast<std::uint16_t>(scene_joint_of_node[index]));
    }
    mesh.influences = {primitive.influences_per_vertex, joints_of_influences,
                       primitive.influence_weights};
  }
  return mesh;
}

// The state of the scene's functions.
struct Player {
  std::shared_ptr<const Scene> asset;
  Evaluator evaluator;
  std::vector<std::vector<std::uint16_t>> influence_joints;  // [instances] of the scene's list
  std::vector<int> places{};                                 // nodes

  std::vector<int> windings(const Evaluation& moment) const {
    std::vector<int> windings;
    for (const Instance& instance : evaluator.instances()) {
      windings.push_back(evaluator.winding(instance, moment));
    }
    return windings;
  }

  SceneMesh::Target displace(const Evaluation& moment, int mesh, int target,
                             ScenePlacement::Memory& room) const {
    const Instance& instance = evaluator.instances()[static_cast<std::size_t>(mesh)];
    const auto index = static_cast<std::size_t>(target);
    const MorphTarget& own = evaluator.primitive(instance).targets[index];
    Displacements world;
    if (!evaluator.displace(instance, index, moment, world)) {
      return {own.name, view(own.positions), view(own.normals), view(own.tangents)};
    }
    room = {std::move(world.positions), std::move(world.normals), std::move(world.tangents)};
    return {own.name, room[0], room[1], room[2]};
  }

  void evaluate(int animation, double time, SceneState& state) const {
    Evaluation evaluation;
    if (state.joints_alone) {
      evaluator.place_nodes(animation, time, evaluation);
      state.positions.clear();
      state.normals.clear();
      state.tangents.clear();
      return take_joints(evaluation, state);
    }
    // Swap the vertex arrays to reuse their memory.
    evaluation.positions = std::move(state.positions);
    evaluation.normals = std::move(state.normals);
    evaluation.tangents = std::move(state.tangents);
    evaluation.with_tangents = true;
    evaluator.evaluate(animation, time, evaluation);
    state.positions = std::move(evaluation.positions);
    state.normals = std::move(evaluation.normals);
    state.tangents = std::move(evaluation.tangents);
    state.windings = windings(evaluation);
    take_joints(evaluation, state);
  }

  void take_joints(const Evaluation& evaluation, SceneState& state) const {
    state.joints.clear();
    for (const int joint : evaluator.joints()) {
      state.joints.push_back(rigid_part(evaluation.node_to_world[static_cast<std::size_t>(joint)]));
    }
    state.places.clear();
    for (const int place : places) {
      state.places.push_back(evaluation.node_to_world[static_cast<std::size_t>(place)]);
    }
  }
};

}  // namespace

std::vector<int> places_of(const Scene& scene, const Evaluator& evaluator) {
  std::vector<char> carries(scene.nodes.size(), 0);
  for (const int joint : evaluator.joints()) carries[static_cast<std::size_t>(joint)] = 1;
  std::vector<int> places;
  const auto& order = evaluator.order();
  for (std::size_t k = order.size(); k-- > 0;) {  // children before parents
    const auto i = static_cast<std::size_t>(order[k]);
    const Node& node = scene.nodes[i];
    if (carries[i] == 0 && node.mesh < 0) {
      if (node.in_scene) places.push_back(order[k]);
    } else if (node.parent >= 0) {
      carries[static_cast<std::size_t>(node.parent)] = 1;
    }
  }
  std::ranges::reverse(places);
  return places;
}

Result<krok::Scene> scene_of(std::shared_ptr<const Scene> from_file) {
  const Scene& asset = *from_file;
  auto evaluator = Evaluator::create(asset);
  if (!evaluator) return evaluator.error();
  const auto player =
      std::make_shared<Player>(Player{std::move(from_file), std::move(*evaluator), {}});
  const Evaluator& from = player->evaluator;

  krok::Scene scene;
  scene.memory = player;
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

  scene.knows_nodes = true;
  scene.properties = asset.properties;
  player->places = places_of(asset, from);
  for (const int place : player->places) {
    const Node& node = asset.nodes[static_cast<std::size_t>(place)];
    scene.places.push_back({node.name, node.parameters});
  }
  player->influence_joints.resize(from.instances().size());
  for (std::size_t i = 0; i < from.instances().size(); ++i) {
    const Instance& instance = from.instances()[i];
    scene.meshes.push_back(mesh_of(asset, instance, from.primitive(instance), scene_joint_of_node,
                                   player->influence_joints[i]));
  }
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    const auto times = from.key_times(static_cast<int>(i));
    scene.animations.push_back({asset.animations[i].name, times,
                                key_gaps(asset.animations[i], times),
                                interpolation_words(asset.animations[i])});
  }
  scene.not_compared = asset.not_shown;
  scene.place = [player](int animation, double time) {
    const auto moment = std::make_shared<Evaluation>();
    player->evaluator.place_nodes(animation, time, *moment);
    ScenePlacement placement;
    placement.windings = player->windings(*moment);
    placement.displace = [player, moment](int mesh, int target, ScenePlacement::Memory& memory) {
      return player->displace(*moment, mesh, target, memory);
    };
    return placement;
  };
  scene.evaluate = [player](int animation, double time, SceneState& state) {
    player->evaluate(animation, time, state);
  };
  return scene;
}

namespace {

constexpr std::size_t kRoomForNumbers = 16;

// The name as valid UTF-8 without zero bytes, truncated to leave room for a number.
std::string usable(const std::string& name) {
  std::string text = to_utf8(name);
  std::erase(text, '\0');
  if (text.size() + kRoomForNumbers <= kLongestName) return text;
  std::size_t end = kLongestName - kRoomForNumbers;
  // Do not cut within a character.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end);
}

}  // namespace

void make_names_unique(std::vector<Material>& materials) {
  std::unordered_set<std::string> taken;
  std::unordered_map<std::string, int> numbers;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    std::string& name = materials[i].name;
    name = usable(name);
    if (name.empty()) name = fmt::format("material_{}", i);
    std::string free = name;
    for (int& number = numbers.try_emplace(name, 1).first->second; !taken.insert(free).second;) {
      free = fmt::format("{}_{}", name, ++number);
    }
    name = std::move(free);
  }
}

}  // namespace krok::nodes
