#include "formats/assimp/scene_transfer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/assimp/material_transfer_internal.h"
#include "formats/assimp/parser_internal.h"

namespace krok::assimp {

using namespace nodes;

namespace {

Node take_node(Parser& in) {
  Node node;
  node.name = in.text();
  node.parent = in.number<std::int32_t>();
  node.has_matrix = in.number<std::uint8_t>() != 0;
  node.matrix = in.matrix();
  node.translation = in.vector();
  node.rotation = in.unit_quaternion();
  node.scale = in.vector();
  node.mesh = in.number<std::int32_t>();
  node.skin = in.number<std::int32_t>();
  node.camera = in.number<std::int32_t>();
  node.fixture = in.number<std::uint8_t>() != 0;
  node.bone = in.number<std::uint8_t>() != 0;
  node.weights = in.array<double>();
  for (const double weight : node.weights)
    in.require(std::isfinite(weight), "a weight is not finite");
  return node;
}

MorphTarget take_target(Parser& in, std::size_t vertices) {
  MorphTarget target;
  target.name = in.text();
  target.positions = in.shared<Vec3f>();
  target.normals = in.shared<Vec3f>();
  for (const auto& values : {target.positions, target.normals}) {
    in.require(!values || values->size() == vertices,
               "a morph target has another number of vertices");
  }
  return target;
}

bool are_tangents(const std::vector<Vec4f>& tangents, std::size_t vertices) {
  return tangents.size() == vertices &&
         std::all_of(tangents.begin(), tangents.end(), [](const Vec4f& tangent) {
           return std::abs(tangent.head<3>().norm() - 1) < 1e-3f && std::abs(tangent.w()) == 1;
         });
}

Primitive take_primitive(Parser& in) {
  Primitive primitive;
  primitive.material = in.text();
  primitive.material_index = in.number<std::int32_t>();
  primitive.positions = in.shared<Vec3f>();
  in.require(primitive.positions != nullptr, "a mesh has no positions");
  if (!primitive.positions) primitive.positions = std::make_shared<const std::vector<Vec3f>>();
  const std::size_t vertices = primitive.vertex_count();
  primitive.normals = in.shared<Vec3f>();
  in.require(!primitive.normals || primitive.normals->size() == vertices, "normals are missing");
  primitive.tangents = in.shared<Vec4f>();
  in.require(!primitive.tangents || are_tangents(*primitive.tangents, vertices),
             "tangents are missing or invalid");
  primitive.texture_coordinates = in.shared<Vec2f>();
  in.require(!primitive.texture_coordinates || primitive.texture_coordinates->size() == vertices,
             "texture coordinates are missing");
  primitive.influences_per_vertex = in.number<std::int32_t>();
  const int each = primitive.influences_per_vertex;
  in.require(each == 0 || each == 4 || each == 8, "an unsupported number of influences per vertex");
  primitive.influence_joints = in.array<std::uint16_t>();
  primitive.influence_weights = in.array<float>();
  if (!in.ok()) return primitive;
  in.require(primitive.influence_joints.size() == vertices * static_cast<std::size_t>(each) &&
                 primitive.influence_weights.size() == primitive.influence_joints.size(),
             "influences are missing");
  for (const float weight : primitive.influence_weights) {
    in.require(weight >= 0.0f && weight <= 1.0f, "an influence is out of range");
  }
  primitive.triangles = in.array<std::array<std::uint32_t, 3>>();
  for (const auto& triangle : primitive.triangles) {
    for (const std::uint32_t corner : triangle) {
      in.require(corner < vertices, "a triangle has a corner that does not exist");
    }
  }
  const std::size_t targets = in.count(10);
  for (std::size_t t = 0; t < targets && in.ok(); ++t) {
    primitive.targets.push_back(take_target(in, vertices));
  }
  return primitive;
}

Mesh take_mesh(Parser& in) {
  Mesh mesh;
  mesh.name = in.text();
  const std::size_t primitives = in.count(16);
  for (std::size_t p = 0; p < primitives && in.ok(); ++p) {
    mesh.primitives.push_back(take_primitive(in));
    in.require(mesh.primitives.back().targets.size() == mesh.target_count(),
               "parts of a mesh have different morph targets");
  }
  mesh.weights = in.array<double>();
  in.require(mesh.weights.size() == mesh.target_count(), "weights of morph targets are missing");
  for (const double weight : mesh.weights)
    in.require(std::isfinite(weight), "a weight is not finite");
  return mesh;
}

Skin take_skin(Parser& in) {
  Skin skin;
  skin.name = in.text();
  const std::vector<std::int32_t> joints = in.array<std::int32_t>();
  skin.joints.assign(joints.begin(), joints.end());
  const std::size_t matrices = in.count(sizeof(double) * 16);
  in.require(!joints.empty() && matrices == joints.size(), "joints of a skin are missing");
  for (std::size_t k = 0; k < matrices && in.ok(); ++k) skin.inverse_binds.push_back(in.matrix());
  return skin;
}

Camera take_camera(Parser& in) {
  Camera camera;
  camera.name = in.text();
  camera.perspective = in.number<std::uint8_t>() != 0;
  camera.field_of_view = in.finite();
  in.require(!camera.perspective || (camera.field_of_view > 0 && camera.field_of_view < kPi),
             "a camera's field of view is out of range");
  return camera;
}

Channel take_channel(Parser& in) {
  Channel channel;
  channel.node = in.number<std::int32_t>();
  const auto path = in.number<std::uint8_t>();
  const auto interpolation = in.number<std::uint8_t>();
  in.require(path <= static_cast<std::uint8_t>(Path::weights) &&
                 interpolation <= static_cast<std::uint8_t>(Interpolation::step),
             "a channel has an unknown kind");
  channel.path = static_cast<Path>(path);
  channel.interpolation = static_cast<Interpolation>(interpolation);
  channel.width = in.number<std::int32_t>();
  channel.times = in.shared<float>();
  channel.values = in.shared<float>();
  in.require(channel.times && channel.values && !channel.times->empty(), "a channel has no keys");
  if (!in.ok()) return channel;
  const std::vector<float>& times = *channel.times;
  for (std::size_t k = 1; k < times.size(); ++k) {
    in.require(times[k] > times[k - 1], "key times are not increasing");
  }
  in.require(channel.width > 0 &&
                 channel.values->size() / static_cast<std::size_t>(channel.width) == times.size() &&
                 channel.values->size() % static_cast<std::size_t>(channel.width) == 0,
             "values of a channel are missing");
  return channel;
}

Diagnostic take_diagnostic(Parser& in) {
  Diagnostic diagnostic;
  const auto severity = in.number<std::uint8_t>();
  in.require(severity <= static_cast<std::uint8_t>(Severity::error),
             "a message has an unknown severity");
  diagnostic.severity = static_cast<Severity>(severity);
  diagnostic.code = in.text();
  diagnostic.message = in.text();
  diagnostic.hint = in.text();
  diagnostic.joint = in.text();
  return diagnostic;
}

template <typename T, typename Take>
void take_list(Parser& in, std::vector<T>& list, Take take) {
  const std::size_t count = in.count(8);  // each has at least 8 bytes
  for (std::size_t i = 0; i < count && in.ok(); ++i) list.push_back(take(in));
}

bool exists(int index, std::size_t count) {
  return index >= 0 && static_cast<std::size_t>(index) < count;
}

// Derives children, roots and in_scene from the parents, which must form trees.
void link_nodes(Parser& in, Scene& scene) {
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    Node& node = scene.nodes[i];
    in.require(node.parent == -1 || exists(node.parent, i), "a node precedes its parent");
    if (!in.ok()) return;
    node.in_scene = true;
    if (node.parent == -1) {
      scene.roots.push_back(static_cast<int>(i));
    } else {
      scene.nodes[static_cast<std::size_t>(node.parent)].children.push_back(static_cast<int>(i));
    }
  }
}

void check_references(Parser& in, const Scene& scene) {
  for (const Skin& skin : scene.skins) {
    for (const int joint : skin.joints) {
      in.require(exists(joint, scene.nodes.size()), "a skin has a joint that does not exist");
    }
  }
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) {
      const int material = primitive.material_index;
      in.require(material == -1 || exists(material, scene.materials.size()),
                 "a material does not exist");
    }
  }
  for (const Node& node : scene.nodes) {
    in.require(node.mesh == -1 || exists(node.mesh, scene.meshes.size()), "a mesh does not exist");
    in.require(node.skin == -1 || exists(node.skin, scene.skins.size()), "a skin does not exist");
    in.require(node.camera == -1 || exists(node.camera, scene.cameras.size()),
               "a camera does not exist");
    if (!in.ok()) return;
    if (node.mesh == -1) continue;
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(node.mesh)];
    in.require(node.weights.empty() || node.weights.size() == mesh.target_count(),
               "weights of a node are missing");
    for (const Primitive& primitive : mesh.primitives) {
      const std::size_t joints =
          node.skin == -1 ? 0 : scene.skins[static_cast<std::size_t>(node.skin)].joints.size();
      for (const std::uint16_t joint : primitive.influence_joints) {
        in.require(joint < joints, "a vertex has a joint that does not exist");
      }
    }
  }
}

void check_channels(Parser& in, const Scene& scene) {
  for (const Animation& animation : scene.animations) {
    for (const Channel& channel : animation.channels) {
      in.require(exists(channel.node, scene.nodes.size()), "an animated node does not exist");
      if (!in.ok()) return;
      std::size_t width = channel.path == Path::rotation ? 4 : 3;
      if (channel.path == Path::weights) {
        const int mesh = scene.nodes[static_cast<std::size_t>(channel.node)].mesh;
        width = mesh < 0 ? 0 : scene.meshes[static_cast<std::size_t>(mesh)].target_count();
      }
      in.require(width > 0 && static_cast<std::size_t>(channel.width) == width,
                 "a channel has the wrong number of values");
    }
  }
}

}  // namespace

Result<Scene> unpack(std::span<const std::byte> bytes) {
  Parser in(bytes);
  Scene scene;
  scene.generator = in.text();
  take_list(in, scene.nodes, take_node);
  take_list(in, scene.meshes, take_mesh);
  take_list(in, scene.skins, take_skin);
  take_list(in, scene.cameras, take_camera);
  take_list(in, scene.animations, [](Parser& from) {
    Animation animation;
    animation.name = from.text();
    take_list(from, animation.channels, take_channel);
    return animation;
  });
  std::vector<std::shared_ptr<const EncodedImage>> images;
  take_list(in, scene.materials, [&](Parser& from) { return take_material(from, images); });
  in.require(check(scene.materials).ok(), "a material has invalid values");
  const bool has_metres = in.number<std::uint8_t>() != 0;
  const double metres = in.finite();
  const bool has_turn = in.number<std::uint8_t>() != 0;
  const Quat turn = in.unit_quaternion();
  in.require(!has_metres || metres > 0, "a unit is not positive");
  if (has_metres) scene.space.metres = metres;
  if (has_turn) scene.space.file_to_krok = turn;
  scene.space.up_is_y = in.number<std::uint8_t>() != 0;
  take_list(in, scene.diagnostics, take_diagnostic);
  in.require(in.at_end(), "there is data after the end");
  link_nodes(in, scene);
  if (in.ok()) check_references(in, scene);
  if (in.ok()) check_channels(in, scene);
  if (in.ok()) return scene;
  return Error("assimp-result",
               fmt::format("Assimp returned invalid data: {}",
                           in.fault().empty() ? "the data ends early" : in.fault()),
               "the file is probably damaged; try to open and save it in another program");
}

}  // namespace krok::assimp
