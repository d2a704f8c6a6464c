#include "formats/gltf/node_reader_internal.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/gltf/reader_words_internal.h"
#include "math/quaternion.h"

namespace krok::gltf {

using namespace nodes;

namespace {

Status read_transform(const tinygltf::Node& source, std::size_t index, Node& node) {
  const auto check_size = [&](const std::vector<double>& values, std::size_t size,
                              const char* what) -> Status {
    if (values.empty() || values.size() == size) return {};
    return Error("gltf-node",
                 fmt::format("{} has a {} of {} numbers, expected {}",
                             label("node", index, node.name), what, values.size(), size));
  };
  for (const auto& ok :
       {check_size(source.matrix, 16, "matrix"), check_size(source.translation, 3, "translation"),
        check_size(source.rotation, 4, "rotation"), check_size(source.scale, 3, "scale")}) {
    if (!ok) return ok;
  }
  if (!source.matrix.empty()) {
    node.has_matrix = true;
    node.matrix = Eigen::Map<const Mat4>(source.matrix.data());
  }
  if (!source.translation.empty()) {
    node.translation = Eigen::Map<const Vec3>(source.translation.data());
  }
  if (!source.rotation.empty()) {
    const auto& q = source.rotation;
    node.rotation = normalized_or_identity(Quat(q[3], q[0], q[1], q[2]));
  }
  if (!source.scale.empty()) node.scale = Eigen::Map<const Vec3>(source.scale.data());
  return {};
}

Status take_nodes(const ParsedJson& parsed, Scene& scene) {
  const tinygltf::Model& model = parsed.model;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const tinygltf::Node& source = model.nodes[i];
    Node& node = scene.nodes.emplace_back();
    node.name = source.name;
    node.children = source.children;
    node.mesh = source.mesh;
    node.skin = source.skin;
    node.camera = source.camera;
    node.weights = source.weights;
    node.fixture = (i < parsed.lights.size() && parsed.lights[i]) ||
                   (i < parsed.marked.size() && parsed.marked[i]);
    node.visible = i >= parsed.hidden.size() || !parsed.hidden[i];
    const std::string name = label("node", i, node.name);
    if (node.mesh != -1 && !exists(node.mesh, model.meshes.size())) {
      return Error("gltf-node",
                   fmt::format("{} has mesh {}, which does not exist", name, node.mesh));
    }
    if (node.skin != -1 && !exists(node.skin, model.skins.size())) {
      return Error("gltf-node",
                   fmt::format("{} has skin {}, which does not exist", name, node.skin));
    }
    if (node.camera != -1 && !exists(node.camera, scene.cameras.size())) {
      warn(
          scene.diagnostics, "gltf-camera",
          fmt::format("{} has camera {}, which does not exist; it is left out", name, node.camera));
      node.camera = -1;
    }
    if (auto read = read_transform(source, i, node); !read) return read;
  }
  return {};
}

// Sets parents and checks that the nodes form trees.
Status link_nodes(std::vector<Node>& nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const int child : nodes[i].children) {
      const std::string name = label("node", i, nodes[i].name);
      if (!exists(child, nodes.size())) {
        return Error("gltf-node",
                     fmt::format("{} has child {}, which does not exist", name, child));
      }
      Node& below = nodes[static_cast<std::size_t>(child)];
      if (below.parent != -1) {
        return Error("gltf-node",
                     fmt::format("{} is a child of two nodes, {} and {}",
                                 label("node", static_cast<std::size_t>(child), below.name),
                                 below.parent, i),
                     "nodes must form trees");
      }
      below.parent = static_cast<int>(i);
    }
  }
  // Each node has at most one parent, so nodes that are not reachable from a root are on a cycle or
  // below one.
  std::vector<int> reached;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].parent == -1) reached.push_back(static_cast<int>(i));
  }
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const Node& node = nodes[static_cast<std::size_t>(reached[k])];
    reached.insert(reached.end(), node.children.begin(), node.children.end());
  }
  // Parents come before their children.
  for (const int index : reached) {
    Node& node = nodes[static_cast<std::size_t>(index)];
    if (node.parent >= 0 && !nodes[static_cast<std::size_t>(node.parent)].visible) {
      node.visible = false;
    }
  }
  if (reached.size() != nodes.size()) {
    return Error("gltf-node",
                 fmt::format("{} nodes are in a cycle or below one", nodes.size() - reached.size()),
                 "nodes must form trees");
  }
  return {};
}

// Sets which nodes are visible.
Status read_scene(const tinygltf::Model& model, Scene& scene) {
  auto& nodes = scene.nodes;
  if (model.defaultScene != -1 && !exists(model.defaultScene, model.scenes.size())) {
    return Error("gltf-node",
                 fmt::format("the default scene is {}, which does not exist", model.defaultScene));
  }
  if (model.scenes.empty()) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i].parent == -1) scene.roots.push_back(static_cast<int>(i));
    }
  } else {
    const std::size_t shown =
        model.defaultScene < 0 ? 0 : static_cast<std::size_t>(model.defaultScene);
    for (const int root : model.scenes[shown].nodes) {
      if (!exists(root, nodes.size())) {
        return Error("gltf-node", fmt::format("the scene has node {}, which does not exist", root));
      }
      if (nodes[static_cast<std::size_t>(root)].parent != -1) {
        return Error("gltf-node",
                     fmt::format("the scene has node {}, which is a child of another node", root),
                     "a scene lists root nodes only");
      }
      if (std::find(scene.roots.begin(), scene.roots.end(), root) == scene.roots.end()) {
        scene.roots.push_back(root);
      }
    }
  }
  std::vector<int> reached = scene.roots;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    Node& node = nodes[static_cast<std::size_t>(reached[k])];
    node.in_scene = true;
    reached.insert(reached.end(), node.children.begin(), node.children.end());
  }
  return {};
}

}  // namespace

Status read_nodes(const ParsedJson& parsed, Scene& scene) {
  if (Status status = take_nodes(parsed, scene); !status) return status;
  if (Status status = link_nodes(scene.nodes); !status) return status;
  return read_scene(parsed.model, scene);
}

}  // namespace krok::gltf
