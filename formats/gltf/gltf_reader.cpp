#include "formats/gltf/gltf_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "core/path_inside.h"
#include "formats/gltf/accessors_internal.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/glb_container.h"
#include "formats/gltf/json_text_internal.h"
#include "formats/gltf/material_reader_internal.h"
#include "formats/gltf/mesh_reader_internal.h"
#include "math/quaternion.h"

namespace krok::gltf {

using namespace nodes;

namespace {

constexpr double kUsualFieldOfView = kPi / 4;

std::string label(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index)
                      : fmt::format("{} {} ({})", kind, index, name);
}

bool exists(int index, std::size_t count) {
  return index >= 0 && static_cast<std::size_t>(index) < count;
}

void warn(Scene& asset, std::string code, std::string message, std::string hint = {}) {
  Diagnostic diagnostic;
  diagnostic.severity = Severity::warning;
  diagnostic.code = std::move(code);
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  asset.diagnostics.push_back(std::move(diagnostic));
}

// Fills in one asset from tinygltf's structures.
class Builder {
 public:
  Builder(const ParsedJson& parsed, Accessors& accessors)
      : parsed_(parsed), model_(parsed.model), accessors_(accessors) {}

  Result<Scene> build() {
    scene_.generator = model_.asset.generator;
    scene_.space = {1.0, Quat::Identity()};  // section 3.4 prescribes both
    for (auto step : {&Builder::read_cameras, &Builder::read_nodes, &Builder::link_nodes,
                      &Builder::read_scene, &Builder::read_all_meshes, &Builder::read_skins,
                      &Builder::check_instances, &Builder::read_animations}) {
      if (auto done = (this->*step)(); !done) return done.error();
    }
    return std::move(scene_);
  }

 private:
  Status read_cameras();
  Status read_nodes();
  Status read_transform(const tinygltf::Node& source, std::size_t index, Node& node);
  Status link_nodes();
  Status read_scene();
  Status read_all_meshes();
  Status read_skins();
  Status check_instances();
  Status read_animations();
  Status read_channel(const tinygltf::Animation& source, std::size_t index, std::size_t channel,
                      Animation& animation);
  Status read_keys(const tinygltf::AnimationSampler& sampler, const std::string& name,
                   Channel& channel);

  const ParsedJson& parsed_;
  const tinygltf::Model& model_;
  Accessors& accessors_;
  Scene scene_;
};

// A lens over time that is not as Krok writes it is another program's and means something else.
void take_lens(const CameraEntry& entry, Camera& camera) {
  const bool good = std::isfinite(entry.lens_rate) && entry.lens_rate > 0 &&
                    std::ranges::all_of(entry.lens, [](float angle) {
                      return angle > 0 && angle < static_cast<float>(kPi);
                    });
  if (!good || entry.lens.empty()) return;
  camera.lens_rate = entry.lens_rate;
  camera.lens = entry.lens;
}

Status Builder::read_cameras() {
  for (std::size_t i = 0; i < parsed_.cameras.size(); ++i) {
    const CameraEntry& entry = parsed_.cameras[i];
    Camera& camera = scene_.cameras.emplace_back();
    camera.name = entry.name;
    camera.perspective = entry.perspective;
    if (!entry.perspective) continue;
    camera.field_of_view = entry.field_of_view;
    if (entry.field_of_view > 0 && entry.field_of_view < kPi) {
      take_lens(entry, camera);
      continue;
    }
    camera.field_of_view = kUsualFieldOfView;
    warn(scene_, "gltf-camera",
         fmt::format("{} has no field of view between 0 and 180 degrees; 45 degrees are taken",
                     label("camera", i, entry.name)));
  }
  return {};
}

Status Builder::read_nodes() {
  for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
    const tinygltf::Node& source = model_.nodes[i];
    Node& node = scene_.nodes.emplace_back();
    node.name = source.name;
    node.children = source.children;
    node.mesh = source.mesh;
    node.skin = source.skin;
    node.camera = source.camera;
    node.weights = source.weights;
    const std::string name = label("node", i, node.name);
    if (node.mesh != -1 && !exists(node.mesh, model_.meshes.size())) {
      return Error("gltf-node",
                   fmt::format("{} has mesh {}, which does not exist", name, node.mesh));
    }
    if (node.skin != -1 && !exists(node.skin, model_.skins.size())) {
      return Error("gltf-node",
                   fmt::format("{} has skin {}, which does not exist", name, node.skin));
    }
    if (node.camera != -1 && !exists(node.camera, scene_.cameras.size())) {
      return Error("gltf-node",
                   fmt::format("{} has camera {}, which does not exist", name, node.camera));
    }
    if (auto read = read_transform(source, i, node); !read) return read;
  }
  return {};
}

Status Builder::read_transform(const tinygltf::Node& source, std::size_t index, Node& node) {
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

// Parents; nodes must form trees.
Status Builder::link_nodes() {
  auto& nodes = scene_.nodes;
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
  // Each node has one parent at most, so whatever cannot be reached from a root lies on a cycle or
  // under one.
  std::vector<int> reached;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].parent == -1) reached.push_back(static_cast<int>(i));
  }
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const Node& node = nodes[static_cast<std::size_t>(reached[k])];
    reached.insert(reached.end(), node.children.begin(), node.children.end());
  }
  if (reached.size() != nodes.size()) {
    return Error("gltf-node",
                 fmt::format("{} nodes are their own ancestors or hang under such",
                             nodes.size() - reached.size()),
                 "nodes must form trees");
  }
  return {};
}

Status Builder::read_scene() {
  auto& nodes = scene_.nodes;
  if (model_.defaultScene != -1 && !exists(model_.defaultScene, model_.scenes.size())) {
    return Error("gltf-node",
                 fmt::format("the default scene is {}, which does not exist", model_.defaultScene));
  }
  if (model_.scenes.empty()) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i].parent == -1) scene_.roots.push_back(static_cast<int>(i));
    }
  } else {
    const std::size_t shown =
        model_.defaultScene < 0 ? 0 : static_cast<std::size_t>(model_.defaultScene);
    for (const int root : model_.scenes[shown].nodes) {
      if (!exists(root, nodes.size())) {
        return Error("gltf-node", fmt::format("the scene has node {}, which does not exist", root));
      }
      if (nodes[static_cast<std::size_t>(root)].parent != -1) {
        return Error("gltf-node",
                     fmt::format("the scene has node {}, which is another's child", root),
                     "a scene lists root nodes only");
      }
      if (std::find(scene_.roots.begin(), scene_.roots.end(), root) == scene_.roots.end()) {
        scene_.roots.push_back(root);
      }
    }
  }
  std::vector<int> reached = scene_.roots;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    Node& node = nodes[static_cast<std::size_t>(reached[k])];
    node.in_scene = true;
    reached.insert(reached.end(), node.children.begin(), node.children.end());
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

// What nodes, meshes and skins promise each other.
Status Builder::check_instances() {
  // The largest joint that a mesh's vertices refer to.
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
      return Error("gltf-skin",
                   fmt::format("{}: a vertex hangs on joint {}, but the skin has {} joints", name,
                               largest, skin.joints.size()));
    }
  }
  return {};
}

Status Builder::read_animations() {
  for (std::size_t i = 0; i < model_.animations.size(); ++i) {
    Animation& animation = scene_.animations.emplace_back();
    animation.name = model_.animations[i].name;
    for (std::size_t c = 0; c < model_.animations[i].channels.size(); ++c) {
      if (auto read = read_channel(model_.animations[i], i, c, animation); !read) return read;
    }
  }
  return {};
}

Status Builder::read_channel(const tinygltf::Animation& source, std::size_t index,
                             std::size_t channel_index, Animation& animation) {
  const tinygltf::AnimationChannel& from = source.channels[channel_index];
  const std::string name =
      fmt::format("{}, channel {}", label("animation", index, source.name), channel_index);
  if (from.target_node < 0) return {};  // to be ignored, says the specification
  if (!exists(from.target_node, scene_.nodes.size())) {
    return Error("gltf-animation",
                 fmt::format("{} moves node {}, which does not exist", name, from.target_node));
  }
  if (!exists(from.sampler, source.samplers.size())) {
    return Error("gltf-animation",
                 fmt::format("{} has sampler {}, which does not exist", name, from.sampler));
  }
  Channel channel;
  channel.node = from.target_node;
  const Node& node = scene_.nodes[static_cast<std::size_t>(channel.node)];
  if (from.target_path == "translation") {
    channel.path = Path::translation;
  } else if (from.target_path == "rotation") {
    channel.path = Path::rotation;
    channel.width = 4;
  } else if (from.target_path == "scale") {
    channel.path = Path::scale;
  } else if (from.target_path == "weights") {
    channel.path = Path::weights;
    const std::size_t targets =
        node.mesh < 0 ? 0 : scene_.meshes[static_cast<std::size_t>(node.mesh)].target_count();
    if (targets == 0) {
      return Error("gltf-animation",
                   fmt::format("{} moves weights of a node without morph targets", name));
    }
    channel.width = static_cast<int>(targets);
  } else {
    warn(scene_, "gltf-animation-path",
         fmt::format("{} moves '{}', which is left aside", name, from.target_path.substr(0, 40)));
    return {};
  }
  if (auto read = read_keys(source.samplers[static_cast<std::size_t>(from.sampler)], name, channel);
      !read) {
    return read;
  }
  if (node.has_matrix && channel.path != Path::weights) {
    warn(scene_, "gltf-animation-matrix",
         fmt::format("{} moves a node that is given by a matrix; the matrix is taken apart", name));
  }
  animation.channels.push_back(std::move(channel));
  return {};
}

Status Builder::read_keys(const tinygltf::AnimationSampler& sampler, const std::string& name,
                          Channel& channel) {
  if (sampler.interpolation == "STEP") {
    channel.interpolation = Interpolation::step;
  } else if (sampler.interpolation == "CUBICSPLINE") {
    channel.interpolation = Interpolation::cubic_spline;
  } else if (!sampler.interpolation.empty() && sampler.interpolation != "LINEAR") {
    return Error("gltf-animation", fmt::format("{} has interpolation '{}'", name,
                                               sampler.interpolation.substr(0, 40)));
  }
  auto times = accessors_.scalars(sampler.input);
  if (!times) return times.error();
  channel.times = std::move(*times);
  const std::vector<float>& keys = *channel.times;
  if (keys.empty()) return Error("gltf-animation", fmt::format("{} has no keys", name));
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (keys[k] >= 0 && (k == 0 || keys[k] > keys[k - 1])) continue;
    return Error("gltf-animation",
                 fmt::format("{}: key time {} is not later than the one before", name, k),
                 "key times must be positive and rise");
  }
  const int components = channel.path == Path::weights ? 1 : channel.width;
  auto values = accessors_.flat(sampler.output, components);
  if (!values) return values.error();
  channel.values = std::move(*values);
  const std::size_t expected = keys.size() * static_cast<std::size_t>(channel.width) *
                               (channel.interpolation == Interpolation::cubic_spline ? 3 : 1);
  if (channel.values->size() != expected) {
    return Error("gltf-animation", fmt::format("{} has {} numbers for {} keys, expected {}", name,
                                               channel.values->size(), keys.size(), expected));
  }
  return {};
}

// So much may be unpacked out of a file: the smallest encoding that glTF has grows by 16 at most,
// plus a sum that any machine has for files that use sparse or empty accessors.
std::uint64_t unpacking_limit(std::uint64_t input_bytes) {
  return (std::uint64_t{64} << 20) + 16 * input_bytes;
}

}  // namespace

Result<Scene> read(std::span<const std::byte> bytes, const ReadOptions& options) {
  if (bytes.size() > std::min<std::uint64_t>(options.most_bytes, 0xFFFFFFFFu)) {
    return Error("gltf-too-large", fmt::format("the file has {} bytes", bytes.size()));
  }
  const auto container = open_container(bytes);
  if (!container) return container.error();
  const auto parsed = parse_json(*container);
  if (!parsed) return parsed.error();
  const auto buffers = open_buffers(parsed->buffers, *container, options);
  if (!buffers) return buffers.error();
  std::uint64_t input_bytes = bytes.size();
  for (const InputFile& file : buffers->files) input_bytes += file.bytes().size();
  Accessors accessors(parsed->model, buffers->views, unpacking_limit(input_bytes));
  auto scene = Builder(*parsed, accessors).build();
  if (!scene) return scene;
  for (const InputFile& file : buffers->files) scene->files.push_back(file.path());
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

}  // namespace krok::gltf
