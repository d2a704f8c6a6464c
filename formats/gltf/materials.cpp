#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/json_text_internal.h"

// Writes materials, textures, eyes, sockets and what joints carry.

namespace krok::gltf {

namespace {

using Json = nlohmann::json;

// The shortest decimal that gives the float: 0.8f as 0.8.
double as_meant(float value) {
  return parse_finite(shortest(value)).value_or(value);
}

template <typename Vector>
std::vector<double> list_of(const Vector& values) {
  std::vector<double> list;
  for (const float value : values) list.push_back(as_meant(value));
  return list;
}

int wrap_code(Texture::Wrap wrap) {
  if (wrap == Texture::Wrap::clamp) return TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
  if (wrap == Texture::Wrap::mirror) return TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT;
  return TINYGLTF_TEXTURE_WRAP_REPEAT;
}

tinygltf::Sampler sampler_of(const Texture& texture) {
  tinygltf::Sampler sampler;
  sampler.magFilter =
      texture.smooth ? TINYGLTF_TEXTURE_FILTER_LINEAR : TINYGLTF_TEXTURE_FILTER_NEAREST;
  sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
  sampler.wrapS = wrap_code(texture.wrap_u);
  sampler.wrapT = wrap_code(texture.wrap_v);
  return sampler;
}

// The material without its textures.
tinygltf::Material factors_of(const Material& from) {
  tinygltf::Material material;
  material.name = from.name;
  material.pbrMetallicRoughness.baseColorFactor = list_of(from.base_color);
  material.pbrMetallicRoughness.metallicFactor = as_meant(from.metallic);
  material.pbrMetallicRoughness.roughnessFactor = as_meant(from.roughness);
  material.emissiveFactor = list_of(from.emissive);
  if (from.alpha == Material::Alpha::blend) material.alphaMode = "BLEND";
  if (from.alpha == Material::Alpha::mask) {
    material.alphaMode = "MASK";
    material.alphaCutoff = as_meant(from.alpha_cutoff);
  }
  material.doubleSided = from.double_sided;
  return material;
}

tinygltf::Value value_of(const Json& json) {
  switch (json.type()) {
    case Json::value_t::boolean:
      return tinygltf::Value(json.get<bool>());
    case Json::value_t::number_integer:
    case Json::value_t::number_unsigned:
      if (const double value = json.get<double>(); std::abs(value) <= 0x7FFFFFFF) {
        return tinygltf::Value(json.get<int>());
      }
      [[fallthrough]];
    case Json::value_t::number_float:
      return tinygltf::Value(json.get<double>());
    case Json::value_t::string:
      return tinygltf::Value(json.get<std::string>());
    case Json::value_t::array: {
      tinygltf::Value::Array list;
      for (const Json& item : json) list.push_back(value_of(item));
      return tinygltf::Value(std::move(list));
    }
    case Json::value_t::object: {
      tinygltf::Value::Object object;
      for (const auto& [key, item] : json.items()) object[key] = value_of(item);
      return tinygltf::Value(std::move(object));
    }
    default:
      return {};
  }
}

// Replaces the numbers of an extension's textures, which are left out where they are -1.
void number_textures(Json& json, const std::vector<int>& numbers) {
  for (auto item = json.begin(); item != json.end();) {
    const Json& index = member(*item, "index");
    if (index.is_number_unsigned() && index.get<std::size_t>() < numbers.size()) {
      const int number = numbers[index.get<std::size_t>()];
      if (number < 0) {
        item = json.erase(item);
        continue;
      }
      (*item)["index"] = number;
    } else if (item->is_structured()) {
      number_textures(*item, numbers);
    }
    ++item;
  }
}

constexpr const char* kAnisotropy = "KHR_materials_anisotropy";
constexpr const char* kUnlit = "KHR_materials_unlit";
constexpr const char* kTransform = "KHR_texture_transform";

// What a texture needs for an image that is neither PNG nor JPEG; null otherwise.
const char* extension_of_image(const tinygltf::Image& image) {
  if (image.mimeType == media_type(ImageKind::webp)) return kWebp;
  return image.mimeType == media_type(ImageKind::ktx2) ? kBasisu : nullptr;
}

// Defaults are not written.
tinygltf::Value transform_of(const Texture& texture) {
  const auto pair = [](const Vec2& values) {
    return tinygltf::Value(
        tinygltf::Value::Array{tinygltf::Value(values.x()), tinygltf::Value(values.y())});
  };
  tinygltf::Value::Object transform;
  if (!texture.offset.isZero(0)) transform["offset"] = pair(texture.offset);
  if (texture.rotation != 0) transform["rotation"] = tinygltf::Value(texture.rotation);
  if (texture.scale != Vec2::Ones()) transform["scale"] = pair(texture.scale);
  return tinygltf::Value(std::move(transform));
}

}  // namespace

void Document::use_extension(const char* name) {
  if (std::ranges::find(gltf.extensionsUsed, name) == gltf.extensionsUsed.end()) {
    gltf.extensionsUsed.emplace_back(name);
  }
}

Result<int> Document::add_image(const EncodedImage& encoded) {
  if (const auto known = images_.find(&encoded); known != images_.end()) return known->second;
  auto facts = image_info(encoded.bytes);
  if (!facts) return std::move(facts.error()).in_file(encoded.path);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = size_;
  view.byteLength = encoded.bytes.size();
  put(encoded.bytes, Keep::view);
  tinygltf::Image image;
  image.name = encoded.name;
  image.mimeType = media_type(facts->kind);
  image.bufferView = static_cast<int>(gltf.bufferViews.size());
  gltf.bufferViews.push_back(std::move(view));
  const int index = static_cast<int>(gltf.images.size());
  gltf.images.push_back(std::move(image));
  images_.emplace(&encoded, index);
  return index;
}

int Document::add_sampler(const Texture& texture) {
  const tinygltf::Sampler sampler = sampler_of(texture);
  const auto known = std::ranges::find(gltf.samplers, sampler);
  const int index = static_cast<int>(known - gltf.samplers.begin());
  if (known == gltf.samplers.end()) gltf.samplers.push_back(sampler);
  return index;
}

// The index of a texture, -1 for none.
Result<int> Document::add_texture(const Texture& texture) {
  if (!texture) return -1;
  const auto image = add_image(*texture.image);
  if (!image) return image;
  // Defaults are not written.
  const int sampler = sampler_of(texture) == sampler_of(Texture()) ? -1 : add_sampler(texture);
  const auto [place, made] =
      textures_.emplace(std::pair(*image, sampler), static_cast<int>(gltf.textures.size()));
  if (made) {
    tinygltf::Texture added;
    added.sampler = sampler;
    if (const char* extension = extension_of_image(gltf.images[at(*image)]); extension != nullptr) {
      added.extensions[extension] = tinygltf::Value({{"source", tinygltf::Value(*image)}});
      use_extension(extension);
      if (std::ranges::find(gltf.extensionsRequired, extension) == gltf.extensionsRequired.end()) {
        gltf.extensionsRequired.emplace_back(extension);  // there is no other image
      }
    } else {
      added.source = *image;
    }
    gltf.textures.push_back(std::move(added));
  }
  return place->second;
}

Result<int> Document::add_material(const std::string& name,
                                   const std::map<std::string, int>& attributes) {
  if (name.empty() && options_.unnamed_is_none) return -1;
  const auto [place, made] = materials_.emplace(name, static_cast<int>(gltf.materials.size()));
  if (!made) return place->second;
  Material usual;
  usual.name = name.empty() ? "default" : name;
  const Material* const given = find_material(options_.materials, name);
  const Material& from = given != nullptr ? *given : usual;
  tinygltf::Material material = factors_of(from);
  const auto use = [&](const Texture& texture) -> Result<int> {
    const std::string set = fmt::format("TEXCOORD_{}", texture.set);
    if (!texture || !attributes.contains(set)) return -1;
    used_sets_[place->second].insert(set);
    if (texture.transforms()) use_extension(kTransform);
    return add_texture(texture);
  };
  const auto refer = [&](const Texture& texture, auto& info) -> Status {
    const auto added = use(texture);
    if (!added) return added.error();
    info.index = *added;
    if (*added < 0) return {};
    info.texCoord = texture.set;
    if (texture.transforms()) info.extensions[kTransform] = transform_of(texture);
    return {};
  };
  Status status = refer(from.base_color_texture, material.pbrMetallicRoughness.baseColorTexture);
  if (status) {
    status = refer(from.metallic_roughness_texture,
                   material.pbrMetallicRoughness.metallicRoughnessTexture);
  }
  if (status) {
    status = refer(from.normal_texture, material.normalTexture);
    material.normalTexture.scale = as_meant(from.normal_scale);
  }
  if (status) status = refer(from.occlusion_texture, material.occlusionTexture);
  if (status) status = refer(from.emissive_texture, material.emissiveTexture);
  if (!status) return status.error();
  if (material.occlusionTexture.index >= 0) {
    material.occlusionTexture.strength = as_meant(from.occlusion_strength);
  }
  if (from.unlit) {
    material.extensions[kUnlit] = tinygltf::Value(tinygltf::Value::Object{});
    use_extension(kUnlit);
  }
  const bool has_tangents = attributes.contains("TANGENT") || material.normalTexture.index >= 0;
  for (const MaterialExtension& extension : from.extensions) {
    if (extension.name == kAnisotropy && !has_tangents) continue;  // it would have no direction
    std::vector<int> textures;
    for (const Texture& texture : extension.textures) {
      const auto added = use(texture);
      if (!added) return added.error();
      textures.push_back(*added);
    }
    Json json = krok::parse_json(extension.json);
    number_textures(json, textures);
    material.extensions[extension.name] = value_of(json);
    use_extension(extension.name.c_str());
  }
  if (!from.extras.empty()) material.extras = value_of(krok::parse_json(from.extras));
  gltf.materials.push_back(std::move(material));
  return place->second;
}

int Document::add_below_joint(int skin, std::size_t joint, const std::string& name,
                              const Transform& to_joint, const char* mark) {
  const auto first =
      static_cast<std::size_t>(gltf.skins[static_cast<std::size_t>(skin)].joints.front());
  const Vec3f place = to_joint.position.cast<float>();
  const Quatf turn = to_joint.orientation.cast<float>();
  tinygltf::Node node;
  node.name = unique_node_name(name);
  if (!place.isZero(0)) node.translation = {place.x(), place.y(), place.z()};
  if (!turn.vec().isZero(0)) node.rotation = {turn.x(), turn.y(), turn.z(), turn.w()};
  if (mark != nullptr) node.extras = tinygltf::Value({{kMark, tinygltf::Value(std::string(mark))}});
  const int index = static_cast<int>(gltf.nodes.size());
  gltf.nodes[first + joint].children.push_back(index);
  gltf.nodes.push_back(std::move(node));
  return index;
}

Status Document::add_eyes(const Skeleton& skeleton, int skin,
                          std::span<const Character::Eye> eyes) {
  for (const Character::Eye& eye : eyes) {
    // Turned by a motion, it is a joint.
    if (skeleton.find(eye_joint_name(eye)) >= 0) continue;
    const int joint = skeleton.find(eye.joint);
    if (joint < 0) {
      return Error("gltf-structure", fmt::format("eye '{}' moves with the joint '{}', which the "
                                                 "skeleton has not",
                                                 shown(eye.name), shown(eye.joint)));
    }
    const auto j = static_cast<std::size_t>(joint);
    const Vec3 place = skeleton.reference[j].inverse() * eye.position.cast<double>();
    // At a joint it only names that, and is no joint of the skeleton when the file is read.
    add_below_joint(skin, j, eye_joint_name(eye), {place, Quat::Identity()},
                    place.cast<float>().norm() < 1e-6f ? kEye : nullptr);
  }
  return {};
}

Status Document::add_sockets(const Skeleton& skeleton, int skin,
                             std::span<const Character::Socket> sockets) {
  for (const Character::Socket& socket : sockets) {
    const int joint = skeleton.find(socket.joint);
    if (joint < 0) {
      return Error("gltf-structure", fmt::format("socket '{}' is at the joint '{}', which the "
                                                 "skeleton has not",
                                                 shown(socket.name), shown(socket.joint)));
    }
    sockets_[socket.name] =
        add_below_joint(skin, static_cast<std::size_t>(joint), socket.name,
                        {socket.offset.cast<double>(), socket.orientation}, kSocket);
  }
  return {};
}

Status Document::add_attached(int skin, std::span<const Attached> attached) {
  for (const Attached& thing : attached) {
    const Model& mesh = *thing.mesh;
    if (Status status = check_mesh(mesh); !status) return status;
    const auto socket = sockets_.find(thing.socket);
    const int parent = socket != sockets_.end()
                           ? socket->second
                           : gltf.skins[static_cast<std::size_t>(skin)]
                                 .joints[static_cast<std::size_t>(thing.joint)];
    const auto attributes = add_shape(*this, mesh, {mesh.positions, mesh.normals, mesh.tangents});
    const auto meshes = add_meshes(mesh, attributes, -1, thing.name, true);
    if (!meshes) return meshes.error();
    for (const MeshNode& made : *meshes) {
      std::erase(gltf.scenes[0].nodes, made.node);
      gltf.nodes[static_cast<std::size_t>(parent)].children.push_back(made.node);
    }
  }
  return {};
}

}  // namespace krok::gltf
