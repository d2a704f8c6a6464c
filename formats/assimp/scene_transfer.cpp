#include "formats/assimp/scene_transfer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "core/bytes.h"
#include "core/text.h"
#include "scene/material.h"

namespace krok::assimp {

using namespace nodes;

namespace {

// Writer and Reader have the same functions for the members of a value, so that the fields of each
// type are listed once, for both directions.
class Writer {
 public:
  template <typename T>
  void number(const T& value) {
    out_.write(value);
  }
  void finite(double value) { out_.write(value); }
  void flag(bool value) { out_.write(static_cast<std::uint8_t>(value)); }
  template <typename T>
  void kind(T value, T /*last*/, const char* /*fault*/) {
    out_.write(static_cast<std::uint8_t>(value));
  }
  void text(std::string_view text) {
    out_.write(static_cast<std::uint64_t>(text.size()));
    out_.append_text(text);
  }
  template <typename T>
  void array(const std::vector<T>& values) {
    out_.write(static_cast<std::uint64_t>(values.size()));
    out_.append(std::as_bytes(std::span(values)));
  }
  template <typename T>
  void shared(const Shared<T>& values) {
    flag(values != nullptr);
    if (values) array(*values);
  }
  template <typename Matrix>
  void numbers(const Matrix& matrix) {
    for (Eigen::Index k = 0; k < matrix.size(); ++k) out_.write(matrix.data()[k]);
  }
  void rotation(const Quat& rotation) { numbers(rotation.coeffs()); }
  template <typename T, typename Fields>
  void list(const std::vector<T>& list, const Fields& fields) {
    out_.write(static_cast<std::uint64_t>(list.size()));
    for (const T& item : list) fields(*this, item);
  }
  // Images that several textures share are written once.
  void image(const std::shared_ptr<const EncodedImage>& image) {
    if (!image) return number(std::int32_t{-1});
    const auto next = static_cast<std::int32_t>(number_of_.size());
    const auto [entry, added] = number_of_.try_emplace(image.get(), next);
    number(entry->second);
    if (!added) return;
    text(image->name);
    text(image->path);
    array(image->bytes);
  }
  std::vector<std::byte> bytes() && { return std::move(out_.buffer()); }

 private:
  ByteWriter out_;
  std::map<const EncodedImage*, std::int32_t> number_of_;
};

// Of untrusted bytes. After a failure, reads return empty values, so that one check at the end is
// enough.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : in_(bytes) {}

  bool ok() const { return in_.ok() && fault_.empty(); }
  const std::string& fault() const { return fault_; }
  bool at_end() const { return in_.remaining() == 0; }
  void require(bool holds, const char* what) {
    if (!holds && fault_.empty()) fault_ = what;
  }

  template <typename T>
  void number(T& value) {
    value = ok() ? in_.read<T>() : T{};
  }
  void finite(double& value) {
    number(value);
    require(std::isfinite(value), "a number is not finite");
  }
  void flag(bool& value) { value = read<std::uint8_t>() != 0; }
  template <typename T>
  void kind(T& value, T last, const char* fault) {
    const auto number = read<std::uint8_t>();
    require(number <= static_cast<std::uint8_t>(last), fault);
    value = static_cast<T>(number);
  }
  void text(std::string& text) { text = to_utf8(in_.take_text(count(1))); }
  template <typename T>
  void array(std::vector<T>& values) {
    values.resize(count(sizeof(T)));
    const auto bytes = in_.take(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  }
  template <typename T>
  void shared(Shared<T>& values) {
    values = nullptr;
    if (read<std::uint8_t>() == 0) return;
    std::vector<T> all;
    array(all);
    const auto* numbers = reinterpret_cast<const float*>(all.data());
    require(std::all_of(numbers, numbers + all.size() * sizeof(T) / sizeof(float),
                        [](float v) { return std::isfinite(v); }),
            "a number is not finite");
    values = std::make_shared<const std::vector<T>>(std::move(all));
  }
  template <typename Matrix>
  void numbers(Matrix& matrix) {
    for (Eigen::Index k = 0; k < matrix.size(); ++k) number(matrix.data()[k]);
    require(matrix.allFinite(), "a number is not finite");
  }
  void rotation(Quat& rotation) {
    numbers(rotation.coeffs());
    require(std::abs(rotation.norm() - 1.0) < 1e-6, "a rotation is not of length 1");
  }
  template <typename T, typename Fields>
  void list(std::vector<T>& list, const Fields& fields) {
    const std::size_t size = count(8);  // each has at least 8 bytes
    for (std::size_t i = 0; i < size && ok(); ++i) fields(*this, list.emplace_back());
  }
  void image(std::shared_ptr<const EncodedImage>& image) {
    const auto number = read<std::int32_t>();
    const auto known = static_cast<std::int32_t>(images_.size());
    require(number >= -1 && number <= known, "a texture has an image that does not exist");
    if (ok() && number == known) {
      EncodedImage added;
      text(added.name);
      text(added.path);
      array(added.bytes);
      images_.push_back(std::make_shared<const EncodedImage>(std::move(added)));
    }
    if (ok() && number >= 0) image = images_[static_cast<std::size_t>(number)];
  }

 private:
  template <typename T>
  T read() {
    return ok() ? in_.read<T>() : T{};
  }
  // The number of elements that follow, each at least `bytes_each` long.
  std::size_t count(std::size_t bytes_each) {
    const auto count = read<std::uint64_t>();
    require(count <= in_.remaining() / bytes_each, "a count is larger than the data");
    return ok() ? static_cast<std::size_t>(count) : 0;
  }

  ByteReader in_;
  std::string fault_;
  std::vector<std::shared_ptr<const EncodedImage>> images_;
};

constexpr auto kMatrixFields = [](auto& io, auto& matrix) { io.numbers(matrix); };

constexpr auto kNodeFields = [](auto& io, auto& node) {
  io.text(node.name);
  io.number(node.parent);
  io.flag(node.has_matrix);
  io.numbers(node.matrix);
  io.numbers(node.translation);
  io.rotation(node.rotation);
  io.numbers(node.scale);
  io.kind(node.parent_scale, Node::ParentScale::compensated, "a node's scale is of unknown kind");
  io.number(node.mesh);
  io.number(node.skin);
  io.number(node.camera);
  io.flag(node.fixture);
  io.flag(node.bone);
  io.array(node.weights);
};

constexpr auto kTargetFields = [](auto& io, auto& target) {
  io.text(target.name);
  io.shared(target.positions);
  io.shared(target.normals);
};

constexpr auto kPrimitiveFields = [](auto& io, auto& primitive) {
  io.text(primitive.material);
  io.number(primitive.material_index);
  io.shared(primitive.positions);
  io.shared(primitive.normals);
  io.shared(primitive.tangents);
  io.shared(primitive.texture_coordinates);
  io.number(primitive.influences_per_vertex);
  io.array(primitive.influence_joints);
  io.array(primitive.influence_weights);
  io.array(primitive.triangles);
  io.list(primitive.targets, kTargetFields);
};

constexpr auto kMeshFields = [](auto& io, auto& mesh) {
  io.text(mesh.name);
  io.list(mesh.primitives, kPrimitiveFields);
  io.array(mesh.weights);
};

constexpr auto kSkinFields = [](auto& io, auto& skin) {
  io.text(skin.name);
  io.array(skin.joints);
  io.list(skin.inverse_binds, kMatrixFields);
};

constexpr auto kCameraFields = [](auto& io, auto& camera) {
  io.text(camera.name);
  io.flag(camera.perspective);
  io.finite(camera.field_of_view);
};

constexpr auto kChannelFields = [](auto& io, auto& channel) {
  io.number(channel.node);
  io.kind(channel.path, Path::weights, "a channel has an unknown kind");
  io.kind(channel.interpolation, Interpolation::step, "a channel has an unknown kind");
  io.number(channel.width);
  io.shared(channel.times);
  io.shared(channel.values);
};

constexpr auto kAnimationFields = [](auto& io, auto& animation) {
  io.text(animation.name);
  io.number(animation.rate);
  io.list(animation.channels, kChannelFields);
};

// The members that convert_materials fills in.
constexpr auto kMaterialFields = [](auto& io, auto& material) {
  constexpr const char* kUnknown = "a material has an unknown kind";
  io.text(material.name);
  for (int k = 0; k < 4; ++k) io.number(material.base_color[k]);
  for (int k = 0; k < 3; ++k) io.number(material.emissive[k]);
  io.number(material.metallic);
  io.number(material.roughness);
  io.kind(material.alpha, Material::Alpha::blend, kUnknown);
  io.flag(material.double_sided);
  for (auto* texture : textures_of(material)) {
    io.image(texture->image);
    io.kind(texture->wrap_u, Texture::Wrap::mirror, kUnknown);
    io.kind(texture->wrap_v, Texture::Wrap::mirror, kUnknown);
  }
};

constexpr auto kDiagnosticFields = [](auto& io, auto& diagnostic) {
  io.kind(diagnostic.severity, Severity::error, "a message has an unknown severity");
  io.text(diagnostic.code);
  io.text(diagnostic.message);
  io.text(diagnostic.hint);
  io.text(diagnostic.joint);
};

// `space` has other types than the scene's: values that may be missing, and whether they are there.
struct PackedSpace {
  bool has_metres = false, has_turn = false, up_is_y = false;
  double metres = 0;
  Quat turn = Quat::Identity();
};

constexpr auto kSceneFields = [](auto& io, auto& scene, auto& space) {
  io.text(scene.generator);
  io.list(scene.nodes, kNodeFields);
  io.list(scene.meshes, kMeshFields);
  io.list(scene.skins, kSkinFields);
  io.list(scene.cameras, kCameraFields);
  io.list(scene.animations, kAnimationFields);
  io.list(scene.materials, kMaterialFields);
  io.flag(space.has_metres);
  io.finite(space.metres);
  io.flag(space.has_turn);
  io.rotation(space.turn);
  io.flag(space.up_is_y);
  io.list(scene.diagnostics, kDiagnosticFields);
};

bool exists(int index, std::size_t count) {
  return index >= 0 && static_cast<std::size_t>(index) < count;
}

// Derives children, roots and in_scene from the parents, which must form trees.
void link_nodes(Reader& in, Scene& scene) {
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

bool are_tangents(const std::vector<Vec4f>& tangents) {
  return std::ranges::all_of(tangents, [](const Vec4f& tangent) {
    return std::abs(tangent.head<3>().norm() - 1) < 1e-3f && std::abs(tangent.w()) == 1;
  });
}

void check_weights(Reader& in, std::span<const double> weights) {
  in.require(std::ranges::all_of(weights, [](double weight) { return std::isfinite(weight); }),
             "a weight is not finite");
}

void check_primitive(Reader& in, const Primitive& primitive) {
  in.require(primitive.positions != nullptr, "a mesh has no positions");
  if (!in.ok()) return;
  const std::size_t vertices = primitive.vertex_count();
  const auto for_each_vertex = [&](const auto& values) {
    return !values || values->size() == vertices;
  };
  in.require(for_each_vertex(primitive.normals), "normals are missing");
  in.require(for_each_vertex(primitive.tangents) &&
                 (!primitive.tangents || are_tangents(*primitive.tangents)),
             "tangents are missing or invalid");
  in.require(for_each_vertex(primitive.texture_coordinates), "texture coordinates are missing");
  const int each = primitive.influences_per_vertex;
  in.require(each == 0 || each == 4 || each == 8, "an unsupported number of influences per vertex");
  in.require(primitive.influence_joints.size() == vertices * static_cast<std::size_t>(each) &&
                 primitive.influence_weights.size() == primitive.influence_joints.size(),
             "influences are missing");
  for (const float weight : primitive.influence_weights) {
    in.require(weight >= 0.0f && weight <= 1.0f, "an influence is out of range");
  }
  for (const auto& triangle : primitive.triangles) {
    for (const std::uint32_t corner : triangle) {
      in.require(corner < vertices, "a triangle has a corner that does not exist");
    }
  }
  for (const MorphTarget& target : primitive.targets) {
    in.require(for_each_vertex(target.positions) && for_each_vertex(target.normals),
               "a morph target has another number of vertices");
  }
}

void check_meshes(Reader& in, const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) {
      check_primitive(in, primitive);
      in.require(primitive.targets.size() == mesh.target_count(),
                 "parts of a mesh have different morph targets");
      const int material = primitive.material_index;
      in.require(material == -1 || exists(material, scene.materials.size()),
                 "a material does not exist");
    }
    in.require(mesh.weights.size() == mesh.target_count(), "weights of morph targets are missing");
    check_weights(in, mesh.weights);
  }
}

void check_references(Reader& in, const Scene& scene) {
  for (const Skin& skin : scene.skins) {
    in.require(!skin.joints.empty() && skin.inverse_binds.size() == skin.joints.size(),
               "joints of a skin are missing");
    for (const int joint : skin.joints) {
      in.require(exists(joint, scene.nodes.size()), "a skin has a joint that does not exist");
    }
  }
  for (const Camera& camera : scene.cameras) {
    in.require(!camera.perspective || (camera.field_of_view > 0 && camera.field_of_view < kPi),
               "a camera's field of view is out of range");
  }
  for (const Node& node : scene.nodes) {
    check_weights(in, node.weights);
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

void check_channel(Reader& in, const Channel& channel, const Scene& scene) {
  in.require(channel.times && channel.values && !channel.times->empty(), "a channel has no keys");
  in.require(exists(channel.node, scene.nodes.size()), "an animated node does not exist");
  if (!in.ok()) return;
  const std::vector<float>& times = *channel.times;
  for (std::size_t k = 1; k < times.size(); ++k) {
    in.require(times[k] > times[k - 1], "key times are not increasing");
  }
  std::size_t width = channel.path == Path::rotation ? 4 : 3;
  if (channel.path == Path::weights) {
    const int mesh = scene.nodes[static_cast<std::size_t>(channel.node)].mesh;
    width = mesh < 0 ? 0 : scene.meshes[static_cast<std::size_t>(mesh)].target_count();
  }
  in.require(width > 0 && static_cast<std::size_t>(channel.width) == width,
             "a channel has the wrong number of values");
  in.require(width > 0 && channel.values->size() / width == times.size() &&
                 channel.values->size() % width == 0,
             "values of a channel are missing");
}

}  // namespace

std::vector<std::byte> pack(const Scene& scene) {
  const Space& of = scene.space;
  const PackedSpace space = {of.metres.has_value(), of.file_to_krok.has_value(), of.up_is_y,
                             of.metres.value_or(0.0), of.file_to_krok.value_or(Quat::Identity())};
  Writer out;
  kSceneFields(out, scene, space);
  return std::move(out).bytes();
}

Result<Scene> unpack(std::span<const std::byte> bytes) {
  Reader in(bytes);
  Scene scene;
  PackedSpace space;
  kSceneFields(in, scene, space);
  in.require(in.at_end(), "there is data after the end");
  in.require(check(scene.materials).ok(), "a material has invalid values");
  in.require(!space.has_metres || space.metres > 0, "a unit is not positive");
  if (space.has_metres) scene.space.metres = space.metres;
  if (space.has_turn) scene.space.file_to_krok = space.turn;
  scene.space.up_is_y = space.up_is_y;
  if (in.ok()) link_nodes(in, scene);
  if (in.ok()) check_meshes(in, scene);
  if (in.ok()) check_references(in, scene);
  for (const Animation& animation : scene.animations) {
    for (const Channel& channel : animation.channels) {
      if (in.ok()) check_channel(in, channel, scene);
    }
  }
  if (in.ok()) return scene;
  return Error("assimp-result",
               fmt::format("Assimp returned invalid data: {}",
                           in.fault().empty() ? "the data ends early" : in.fault()),
               "the file is probably damaged; try to open and save it in another program");
}

}  // namespace krok::assimp
