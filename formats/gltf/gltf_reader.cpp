#include "formats/gltf/gltf_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/file.h"
#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/gltf/accessors_internal.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/glb_container_internal.h"
#include "formats/gltf/json_text_internal.h"
#include "formats/gltf/reader_internal.h"
#include "math/quaternion.h"

namespace krok::gltf {

namespace {

using namespace nodes;

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
    if (i < parsed.node_parameters.size()) node.parameters = parsed.node_parameters[i];
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

// A scene lists roots alone. Of one that lists other nodes, too, those stay where their parents put
// them; the trees that they are in take their place.
void replace_by_trees(Scene& scene) {
  std::vector<int> trees;
  std::vector<bool> taken(scene.nodes.size(), false);
  std::string nested;
  for (const int listed : scene.roots) {
    int top = listed;
    while (scene.nodes[static_cast<std::size_t>(top)].parent >= 0) {
      top = scene.nodes[static_cast<std::size_t>(top)].parent;
    }
    if (top != listed && nested.empty()) {
      const auto index = static_cast<std::size_t>(listed);
      nested = label("node", index, scene.nodes[index].name);
    }
    if (!taken[static_cast<std::size_t>(top)]) trees.push_back(top);
    taken[static_cast<std::size_t>(top)] = true;
  }
  if (nested.empty()) return;
  scene.roots = std::move(trees);
  warn(scene.diagnostics, "gltf-node",
       fmt::format("the scene lists {}, which is a child of another node; it is shown where that "
                   "puts it",
                   nested));
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
      if (std::find(scene.roots.begin(), scene.roots.end(), root) == scene.roots.end()) {
        scene.roots.push_back(root);
      }
    }
  }
  std::vector<int> reached = scene.roots;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    Node& node = nodes[static_cast<std::size_t>(reached[k])];
    if (node.in_scene) continue;
    node.in_scene = true;
    reached.insert(reached.end(), node.children.begin(), node.children.end());
  }
  replace_by_trees(scene);
  return {};
}

// Call after cameras were read. Code: gltf-node; a camera that does not exist is a warning.
Status read_nodes(const ParsedJson& parsed, Scene& scene) {
  if (Status status = take_nodes(parsed, scene); !status) return status;
  if (Status status = link_nodes(scene.nodes); !status) return status;
  return read_scene(parsed.model, scene);
}

}  // namespace

using namespace nodes;

namespace {

constexpr double kUsualFieldOfView = kPi / 4;
constexpr std::size_t kMaxInstances = 100'000;

// Builds a scene from tinygltf's structures.
class Builder {
 public:
  Builder(const ParsedJson& parsed, Accessors& accessors)
      : parsed_(parsed), model_(parsed.model), accessors_(accessors) {}

  Result<Scene> build() {
    scene_.generator = model_.asset.generator;
    scene_.space = {1.0, Quat::Identity()};  // section 3.4
    scene_.not_shown = parsed_.not_shown;
    scene_.properties = parsed_.properties;
    for (auto step : {&Builder::read_cameras, &Builder::read_nodes, &Builder::read_all_meshes,
                      &Builder::read_skins, &Builder::check_instances, &Builder::place_instances,
                      &Builder::read_animations}) {
      if (auto done = (this->*step)(); !done) return done.error();
    }
    return std::move(scene_);
  }

 private:
  Status read_cameras();
  Status read_nodes() { return gltf::read_nodes(parsed_, scene_); }
  Status read_all_meshes();
  Status read_skins();
  Status check_instances();
  Status place_instances();
  Status read_animations() { return gltf::read_animations(parsed_, accessors_, scene_); }

  const ParsedJson& parsed_;
  const tinygltf::Model& model_;
  Accessors& accessors_;
  Scene scene_;
};

Status Builder::read_cameras() {
  const auto is_angle = [](double angle) { return angle > 0 && angle < kPi; };
  scene_.cameras = parsed_.cameras;
  for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
    Camera& camera = scene_.cameras[i];
    const bool good = camera.perspective && is_angle(camera.field_of_view);
    // An animated lens that is not in Krok's form was written by another program.
    if (!good || camera.lens.empty() || !(camera.lens_rate > 0) ||
        !std::isfinite(camera.lens_rate) || !std::ranges::all_of(camera.lens, is_angle)) {
      camera.lens_rate = 0;
      camera.lens.clear();
    }
    if (good) continue;
    camera.field_of_view = camera.perspective ? kUsualFieldOfView : 0;
    if (!camera.perspective) continue;
    warn(scene_.diagnostics, "gltf-camera",
         fmt::format("{} has no field of view between 0 and 180 degrees; 45 degrees are used",
                     label("camera", i, camera.name)));
  }
  return {};
}

Status Builder::read_all_meshes() {
  for (std::size_t i = 0; i < model_.meshes.size(); ++i) {
    auto mesh = read_mesh(parsed_, i, accessors_, scene_.diagnostics);
    if (!mesh) return mesh.error();
    scene_.meshes.push_back(std::move(*mesh));
  }
  return {};
}

Status Builder::read_skins() {
  for (std::size_t i = 0; i < model_.skins.size(); ++i) {
    const tinygltf::Skin& source = model_.skins[i];
    Skin& skin = scene_.skins.emplace_back();
    skin.name = source.name;
    skin.joints = source.joints;
    const std::string name = label("skin", i, skin.name);
    if (skin.joints.empty()) return Error("gltf-skin", fmt::format("{} has no joints", name));
    for (const int joint : skin.joints) {
      if (exists(joint, scene_.nodes.size())) continue;
      return Error("gltf-skin", fmt::format("{} has joint {}, which does not exist", name, joint));
    }
    if (source.inverseBindMatrices < 0) {
      skin.inverse_binds.assign(skin.joints.size(), Mat4::Identity());
      continue;
    }
    auto matrices = accessors_.matrices(source.inverseBindMatrices);
    if (!matrices) return matrices.error();
    if (matrices->size() < skin.joints.size()) {
      return Error("gltf-skin", fmt::format("{} has {} joints but {} inverse bind matrices", name,
                                            skin.joints.size(), matrices->size()));
    }
    matrices->resize(skin.joints.size());
    skin.inverse_binds = std::move(*matrices);
  }
  return {};
}

// Checks that nodes, meshes and skins are consistent.
Status Builder::check_instances() {
  // The largest joint index in each mesh.
  std::vector<int> largest_joint(scene_.meshes.size(), -1);
  for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
    for (const Primitive& primitive : scene_.meshes[m].primitives) {
      for (const std::uint16_t joint : primitive.influence_joints) {
        largest_joint[m] = std::max(largest_joint[m], static_cast<int>(joint));
      }
    }
  }
  for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
    const Node& node = scene_.nodes[i];
    if (node.mesh < 0) continue;
    const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(node.mesh)];
    const std::string name = label("node", i, node.name);
    if (!node.weights.empty() && node.weights.size() != mesh.target_count()) {
      return Error("gltf-node", fmt::format("{} has {} weights for {} morph targets", name,
                                            node.weights.size(), mesh.target_count()));
    }
    if (node.skin < 0) continue;
    const Skin& skin = scene_.skins[static_cast<std::size_t>(node.skin)];
    const int largest = largest_joint[static_cast<std::size_t>(node.mesh)];
    if (largest >= static_cast<int>(skin.joints.size())) {
      return Error("gltf-skin", fmt::format("{}: a vertex has joint {}, but the skin has {} joints",
                                            name, largest, skin.joints.size()));
    }
  }
  return {};
}

// The places of EXT_mesh_gpu_instancing, relative to their node.
struct InstancePlaces {
  std::size_t count = 0;
  Shared<Vec3f> translations, scales;
  std::vector<float> rotations;  // xyzw of each
};

Result<InstancePlaces> read_places(const InstancedNode& instanced, Accessors& accessors,
                                   const std::string& name) {
  InstancePlaces places;
  std::size_t least = SIZE_MAX;
  for (const auto& [attribute, accessor] : instanced.attributes) {
    std::size_t size = 0;
    if (attribute == "TRANSLATION" || attribute == "SCALE") {
      auto read = accessors.vectors3(accessor);
      if (!read) return read.error();
      size = (*read)->size();
      (attribute == "SCALE" ? places.scales : places.translations) = std::move(*read);
    } else if (attribute == "ROTATION") {
      auto read = accessors.vectors4(accessor);
      if (!read) return read.error();
      size = read->size() / 4;
      places.rotations = std::move(*read);
    } else {
      continue;
    }
    places.count = std::max(places.count, size);
    least = std::min(least, size);
  }
  if (places.count > 0 && least != places.count) {
    return Error("gltf-node", fmt::format("{} has {} and {} values for its instances", name, least,
                                          places.count));
  }
  return places;
}

// Instances become children of their node, which hands its mesh on to them.
Status Builder::place_instances() {
  for (const InstancedNode& instanced : parsed_.instanced) {
    const Node source = scene_.nodes[instanced.node];
    const std::string name = label("node", instanced.node, source.name);
    if (source.mesh < 0) continue;
    if (source.skin >= 0) {
      warn(scene_.diagnostics, "gltf-instancing",
           fmt::format("{} has a skin, so its instances are ignored", name));
      continue;
    }
    const auto places = read_places(instanced, accessors_, name);
    if (!places) return places.error();
    if (places->count > kMaxInstances) {
      return Error("gltf-too-large", fmt::format("{} has {} instances", name, places->count));
    }
    if (auto taken = accessors_.reserve(places->count * sizeof(Node)); !taken) return taken;
    scene_.nodes[instanced.node].mesh = -1;
    scene_.nodes[instanced.node].weights.clear();
    for (std::size_t i = 0; i < places->count; ++i) {
      const int index = static_cast<int>(scene_.nodes.size());
      Node& node = scene_.nodes.emplace_back();
      node.name = source.name;
      node.parent = static_cast<int>(instanced.node);
      node.mesh = source.mesh;
      node.weights = source.weights;
      node.in_scene = source.in_scene;
      node.visible = source.visible;
      if (places->translations) node.translation = (*places->translations)[i].cast<double>();
      if (places->scales) node.scale = (*places->scales)[i].cast<double>();
      if (!places->rotations.empty()) {
        const float* q = &places->rotations[4 * i];
        node.rotation = normalized_or_identity(Quatf(q[3], q[0], q[1], q[2]).cast<double>());
      }
      Node& parent = scene_.nodes[instanced.node];
      parent.children.push_back(index);
      parent.instances.push_back(index);
    }
  }
  return {};
}

// Notes what of the meshes is not read, once for each kind with its count.
void report_unread(const ParsedJson& parsed, Scene& scene) {
  constexpr std::array kRead = {"POSITION", "NORMAL", "TANGENT", "COLOR_0"};
  constexpr std::array kReadSets = {"TEXCOORD_", "JOINTS_", "WEIGHTS_"};
  std::map<std::string, long long> unread;
  for (const tinygltf::Mesh& mesh : parsed.model.meshes) {
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      for (const auto& attribute : primitive.attributes) {
        const std::string& name = attribute.first;
        const bool read =
            std::ranges::find(kRead, name) != kRead.end() ||
            std::ranges::any_of(kReadSets, [&](const char* set) { return name.starts_with(set); });
        if (!read) ++unread[name];
      }
    }
  }
  std::vector<std::string> words;
  constexpr std::size_t kMaxListed = 12;
  for (const auto& [name, count] : unread) {
    if (words.size() == kMaxListed) break;
    words.push_back(fmt::format("{} of {}", shown(name), counted(count, "primitive")));
  }
  if (unread.size() > kMaxListed) words.emplace_back("others");
  if (words.empty()) return;
  warn(scene.diagnostics, "gltf-unread", fmt::format("not read: {}", fmt::join(words, "; ")));
  scene.diagnostics.back().severity = Severity::note;
}

// Limit on unpacked data: glTF's smallest encoding grows by at most a factor of 16; the constant
// part allows for sparse and empty accessors.
std::uint64_t unpacking_limit(std::uint64_t input_bytes) {
  return (std::uint64_t{64} << 20) + 16 * input_bytes;
}

// Limit on what is decompressed. Both codecs get about a sixteenth of dense meshes and far less of
// flat ones, such as a ground.
std::uint64_t decompression_limit(std::uint64_t input_bytes) {
  return (std::uint64_t{256} << 20) + 64 * input_bytes;
}

}  // namespace

Result<Scene> read(std::span<const std::byte> bytes, const ReadOptions& options) {
  if (bytes.size() > std::min<std::uint64_t>(options.most_bytes, 0xFFFFFFFFu)) {
    return Error("gltf-too-large", fmt::format("the file has {} bytes", bytes.size()));
  }
  const auto container = open_container(bytes);
  if (!container) return container.error();
  auto parsed = parse_json(*container);
  if (!parsed) return parsed.error();
  if (!options.draco && !parsed->packed_primitives.empty()) {
    return Error(
        "gltf-compression", "its meshes are compressed by Draco, which is not supported here",
        "import it with krok-import --save-character, or decompress it in another program");
  }
  auto buffers = open_buffers(parsed->buffers, *container, options);
  if (!buffers) return buffers.error();
  std::uint64_t input_bytes = bytes.size();
  for (const SideFile& file : buffers->files) input_bytes += file.bytes().size();
  for (const bool draco : {false, true}) {
    const std::size_t before = buffers->views.size();
    const std::uint64_t limit = decompression_limit(input_bytes);
    Status status = draco ? unpack_draco(*parsed, *buffers, limit, options.limits)
                          : unpack_meshopt(*parsed, *buffers, limit);
    if (!status) return status.error();
    for (std::size_t b = before; b < buffers->views.size(); ++b) {
      input_bytes += buffers->views[b].size();
    }
  }
  Accessors accessors(parsed->model, buffers->views, unpacking_limit(input_bytes));
  auto scene = Builder(*parsed, accessors).build();
  if (!scene) return scene;
  report_unread(*parsed, *scene);
  for (const SideFile& file : buffers->files) {
    if (file.file) scene->files.push_back(file.path);
  }
  if (options.with_materials) read_materials(*parsed, buffers->views, options, *scene);
  return scene;
}

Result<Scene> read_file(const std::string& path, ReadOptions options) {
  const auto file = InputFile::open(path);
  if (!file) return file.error();
  options.folder = folder_of(path);
  auto asset = read(file->bytes(), options);
  if (!asset) return std::move(asset.error()).in_file(path);
  for (Diagnostic& diagnostic : asset->diagnostics) diagnostic.where.file = path;
  return asset;
}

std::string label(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index)
                      : fmt::format("{} {} ({})", kind, index, name);
}

void warn(Diagnostics& diagnostics, std::string code, std::string message, std::string hint) {
  diagnostics.push_back(make_warning(std::move(code), std::move(message), std::move(hint)));
}

}  // namespace krok::gltf
