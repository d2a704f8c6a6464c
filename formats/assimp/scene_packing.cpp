#include "formats/assimp/scene_transfer.h"

#include <map>

#include "formats/assimp/material_transfer_internal.h"

namespace krok::assimp {

using namespace nodes;

namespace {

template <typename T>
void put_shared(ByteWriter& out, const Shared<T>& values) {
  out.write(static_cast<std::uint8_t>(values ? 1 : 0));
  if (values) put_array(out, *values);
}

void put_matrix(ByteWriter& out, const Mat4& matrix) {
  for (int k = 0; k < 16; ++k) out.write(matrix.data()[k]);
}

void put_node(ByteWriter& out, const Node& node) {
  put_text(out, node.name);
  out.write(static_cast<std::int32_t>(node.parent));
  out.write(static_cast<std::uint8_t>(node.has_matrix));
  put_matrix(out, node.matrix);
  for (int k = 0; k < 3; ++k) out.write(node.translation[k]);
  for (int k = 0; k < 4; ++k) out.write(node.rotation.coeffs()[k]);
  for (int k = 0; k < 3; ++k) out.write(node.scale[k]);
  out.write(static_cast<std::int32_t>(node.mesh));
  out.write(static_cast<std::int32_t>(node.skin));
  out.write(static_cast<std::int32_t>(node.camera));
  out.write(static_cast<std::uint8_t>(node.fixture));
  out.write(static_cast<std::uint8_t>(node.bone));
  put_array(out, node.weights);
}

void put_primitive(ByteWriter& out, const Primitive& primitive) {
  put_text(out, primitive.material);
  out.write(static_cast<std::int32_t>(primitive.material_index));
  put_shared(out, primitive.positions);
  put_shared(out, primitive.normals);
  put_shared(out, primitive.tangents);
  put_shared(out, primitive.texture_coordinates);
  out.write(static_cast<std::int32_t>(primitive.influences_per_vertex));
  put_array(out, primitive.influence_joints);
  put_array(out, primitive.influence_weights);
  put_array(out, primitive.triangles);
  out.write(static_cast<std::uint64_t>(primitive.targets.size()));
  for (const MorphTarget& target : primitive.targets) {
    put_text(out, target.name);
    put_shared(out, target.positions);
    put_shared(out, target.normals);
  }
}

void put_channel(ByteWriter& out, const Channel& channel) {
  out.write(static_cast<std::int32_t>(channel.node));
  out.write(static_cast<std::uint8_t>(channel.path));
  out.write(static_cast<std::uint8_t>(channel.interpolation));
  out.write(static_cast<std::int32_t>(channel.width));
  put_shared(out, channel.times);
  put_shared(out, channel.values);
}

void put_diagnostic(ByteWriter& out, const Diagnostic& diagnostic) {
  out.write(static_cast<std::uint8_t>(diagnostic.severity));
  put_text(out, diagnostic.code);
  put_text(out, diagnostic.message);
  put_text(out, diagnostic.hint);
  put_text(out, diagnostic.joint);
}

template <typename T, typename Put>
void put_list(ByteWriter& out, const std::vector<T>& list, Put put) {
  out.write(static_cast<std::uint64_t>(list.size()));
  for (const T& item : list) put(out, item);
}

}  // namespace

std::vector<std::byte> pack(const Scene& scene) {
  ByteWriter out;
  put_text(out, scene.generator);
  put_list(out, scene.nodes, put_node);
  put_list(out, scene.meshes, [](ByteWriter& to, const Mesh& mesh) {
    put_text(to, mesh.name);
    put_list(to, mesh.primitives, put_primitive);
    put_array(to, mesh.weights);
  });
  put_list(out, scene.skins, [](ByteWriter& to, const Skin& skin) {
    put_text(to, skin.name);
    put_array(to, std::vector<std::int32_t>(skin.joints.begin(), skin.joints.end()));
    put_list(to, skin.inverse_binds, put_matrix);
  });
  put_list(out, scene.cameras, [](ByteWriter& to, const Camera& camera) {
    put_text(to, camera.name);
    to.write(static_cast<std::uint8_t>(camera.perspective));
    to.write(camera.field_of_view);
  });
  put_list(out, scene.animations, [](ByteWriter& to, const Animation& animation) {
    put_text(to, animation.name);
    put_list(to, animation.channels, put_channel);
  });
  std::map<const EncodedImage*, std::int32_t> number_of;
  put_list(out, scene.materials, [&](ByteWriter& to, const Material& material) {
    put_material(to, material, number_of);
  });
  out.write(static_cast<std::uint8_t>(scene.space.metres.has_value()));
  out.write(scene.space.metres.value_or(0.0));
  out.write(static_cast<std::uint8_t>(scene.space.file_to_krok.has_value()));
  const Quat turn = scene.space.file_to_krok.value_or(Quat::Identity());
  for (int k = 0; k < 4; ++k) out.write(turn.coeffs()[k]);
  out.write(static_cast<std::uint8_t>(scene.space.up_is_y));
  put_list(out, scene.diagnostics, put_diagnostic);
  return std::move(out.buffer());
}

}  // namespace krok::assimp
