#include "formats/gltf/reader_internal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "core/text.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/json_text_internal.h"
#include "nodes/scene.h"
#include "scene/encoded_image.h"

namespace krok::gltf {

namespace {

using Json = nlohmann::json;

// Loads images from buffers, data URIs and external files. Nothing in the file is trusted. Memory
// is proportional to the input: all images from buffers together take at most the size of the
// buffers.
class Images {
 public:
  Images(const ParsedJson& parsed, std::span<const std::span<const std::byte>> buffers,
         const ReadOptions& options);

  // The image with this index, loaded once; null if it is unusable, with a warning (code
  // gltf-picture) on the first call.
  std::shared_ptr<const EncodedImage> get(std::size_t image, Diagnostics& diagnostics);

  // Paths of the external files that were read.
  const std::vector<std::string>& files() const { return files_; }

 private:
  Result<std::shared_ptr<const EncodedImage>> read(std::size_t image);
  Result<std::vector<std::byte>> bytes_of_view(const Json& number);
  Result<std::shared_ptr<const EncodedImage>> beside(const std::string& uri,
                                                     const std::string& name);

  const ParsedJson& parsed_;
  std::span<const std::span<const std::byte>> buffers_;
  const ReadOptions& options_;
  std::uint64_t in_buffers_left_ = 0, beside_left_ = 0;               // bytes
  std::map<std::size_t, std::shared_ptr<const EncodedImage>> known_;  // by index
  std::map<std::string, std::shared_ptr<const EncodedImage>> by_file_;
  std::vector<std::string> files_;
};

Error bad_image(std::string message, std::string hint = {}) {
  return Error("gltf-picture", std::move(message), std::move(hint));
}

std::shared_ptr<const EncodedImage> made(std::string name, std::string path,
                                         std::vector<std::byte> bytes) {
  return std::make_shared<const EncodedImage>(
      EncodedImage{std::move(name), std::move(path), std::move(bytes)});
}

Images::Images(const ParsedJson& parsed, std::span<const std::span<const std::byte>> buffers,
               const ReadOptions& options)
    : parsed_(parsed), buffers_(buffers), options_(options), beside_left_(options.most_bytes) {
  for (const auto& buffer : buffers) in_buffers_left_ += buffer.size();
}

std::shared_ptr<const EncodedImage> Images::get(std::size_t index, Diagnostics& diagnostics) {
  const auto [place, added] = known_.try_emplace(index);
  if (!added) return place->second;
  auto image = read(index);
  if (image) {
    const auto facts = image_info((*image)->bytes);
    if (facts) return place->second = *std::move(image);
    image = facts.error();
  }
  Diagnostic warning = image.error();
  warning.severity = Severity::warning;
  warning.code = "gltf-picture";
  warning.message = fmt::format("image {} is left out: {}", index, warning.message);
  diagnostics.push_back(std::move(warning));
  return nullptr;
}

Result<std::shared_ptr<const EncodedImage>> Images::read(std::size_t image) {
  const Json& images = member(parsed_.look, "images");
  if (!images.is_array() || image >= images.size()) return bad_image("it does not exist");
  const Json& entry = images[image];
  if (!entry.is_object()) return bad_image("it is not an object");
  const std::string name = text_member(entry, "name");
  if (const auto view = entry.find("bufferView"); view != entry.end()) {
    auto bytes = bytes_of_view(*view);
    if (!bytes) return bytes.error();
    return made(name, {}, *std::move(bytes));
  }
  const std::string uri = text_member(entry, "uri");
  if (!is_data_uri(uri)) return beside(uri, name);
  const auto decoded = decode_data_uri(uri, "the image");
  if (!decoded) return decoded.error();
  const auto bytes = std::as_bytes(std::span(*decoded));
  return made(name, {}, {bytes.begin(), bytes.end()});
}

Result<std::vector<std::byte>> Images::bytes_of_view(const Json& number) {
  const auto& views = parsed_.model.bufferViews;
  const auto index = number.is_number_unsigned() ? number.get<std::uint64_t>() : views.size();
  if (index >= views.size()) return bad_image("its buffer view does not exist");
  const tinygltf::BufferView& view = views[static_cast<std::size_t>(index)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= buffers_.size()) {
    return bad_image("its buffer does not exist");
  }
  const auto buffer = buffers_[static_cast<std::size_t>(view.buffer)];
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    return bad_image("it is outside its buffer");
  }
  if (view.byteLength > in_buffers_left_) return bad_image("images share bytes");
  in_buffers_left_ -= view.byteLength;
  const auto bytes = buffer.subspan(view.byteOffset, view.byteLength);
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Result<std::shared_ptr<const EncodedImage>> Images::beside(const std::string& uri,
                                                           const std::string& name) {
  if (uri.empty()) return bad_image("it has neither data nor a URI");
  const auto file = open_beside(uri, "image", options_, beside_left_);
  if (!file) return file.error();
  std::error_code error;
  const auto real = std::filesystem::canonical(file->path, error);
  const std::string place = error || options_.open ? file->path : real.string();
  if (const auto known = by_file_.find(place); known != by_file_.end()) return known->second;
  const auto bytes = file->bytes();
  beside_left_ -= std::min<std::uint64_t>(beside_left_, bytes.size());
  if (file->file) files_.push_back(file->path);
  return by_file_[place] = made(name, file->path, {bytes.begin(), bytes.end()});
}

const Json kNothing = Json::object();

// A member that is an object; an empty object if there is none.
const Json& object_in(const Json& object, const char* key) {
  const Json& found = member(object, key);
  return found.is_object() ? found : kNothing;
}

// The list entry with an index given in the JSON; null if there is none.
const Json* entry_of(const Json& root, const char* list, const Json& number) {
  const Json& entries = member(root, list);
  if (!entries.is_array() || !number.is_number_unsigned()) return nullptr;
  const auto index = number.get<std::uint64_t>();
  return index < entries.size() && entries[index].is_object() ? &entries[index] : nullptr;
}

class MaterialReader {
 public:
  MaterialReader(const ParsedJson& parsed, std::span<const std::span<const std::byte>> buffers,
                 const ReadOptions& options, nodes::Scene& scene)
      : parsed_(parsed), scene_(scene), images_(parsed, buffers, options) {}

  void read() {
    const Json& list = member(parsed_.look, "materials");
    if (!list.is_array()) return;
    for (std::size_t m = 0; m < list.size(); ++m) {
      parameters_.clear();
      scene_.materials.push_back(read_material(list[m]));
      scene_.material_parameters.push_back(std::move(parameters_));
      scene_.materials.back().name = parsed_.material_names[m];
    }
    nodes::make_names_unique(scene_.materials);
    for (const std::string& file : images_.files()) scene_.files.push_back(file);
    tell();
  }

 private:
  Material read_material(const Json& json) {
    Material material;
    if (!json.is_object()) return material;
    read_surface(json, material);
    read_parameters(json);
    if (const Json& extras = member(json, "extras"); !extras.is_null()) {
      material.extras = json_text(extras);
    }
    const Json& normal = object_in(json, "normalTexture");
    material.normal_texture = texture(normal);
    material.normal_scale = factor(normal, "scale", 1, -kMaxNormalScale, kMaxNormalScale);
    const Json& occlusion = object_in(json, "occlusionTexture");
    material.occlusion_texture = texture(occlusion);
    material.occlusion_strength = factor(occlusion, "strength", 1);
    material.emissive_texture = texture(object_in(json, "emissiveTexture"));
    material.emissive = factors<3>(json, "emissiveFactor", 0);
    const Json& mode = member(json, "alphaMode");
    if (mode == "BLEND") material.alpha = Material::Alpha::blend;
    if (mode == "MASK") material.alpha = Material::Alpha::mask;
    material.alpha_cutoff = factor(json, "alphaCutoff", 0.5f);
    material.double_sided = member(json, "doubleSided") == true;
    return material;
  }

  // The metallic-roughness parameters, approximated if the file has only the older
  // specular-glossiness ones.
  void read_surface(const Json& json, Material& material) {
    const Json& extensions = object_in(json, "extensions");
    material.unlit = extensions.contains("KHR_materials_unlit");
    for (const auto& [name, value] : extensions.items()) {
      if (name == "KHR_materials_unlit") continue;
      // Others may refer to parts of the file by number.
      const bool known = name.find("_materials_") != std::string::npos && value.is_object();
      known ? keep_extension(name, value, material) : void(left_aside_.insert(name));
    }
    const Json& surface = object_in(json, "pbrMetallicRoughness");
    const Json& glossy = object_in(extensions, "KHR_materials_pbrSpecularGlossiness");
    if (surface.empty() && !glossy.empty()) {
      material.base_color = factors<4>(glossy, "diffuseFactor", 1);
      material.base_color_texture = texture(object_in(glossy, "diffuseTexture"));
      material.roughness = 1.0f - factor(glossy, "glossinessFactor", 1);
      return;
    }
    material.base_color = factors<4>(surface, "baseColorFactor", 1);
    material.base_color_texture = texture(object_in(surface, "baseColorTexture"));
    material.metallic = factor(surface, "metallicFactor", 1);
    material.roughness = factor(surface, "roughnessFactor", 1);
    material.metallic_roughness_texture = texture(object_in(surface, "metallicRoughnessTexture"));
  }

  void keep_extension(const std::string& name, Json value, Material& material) {
    MaterialExtension& kept = material.extensions.emplace_back();
    take_textures(value, kept.textures);
    kept.name = name;
    kept.json = json_text(value);
  }

  // Moves the textures out, leaving their numbers; those without an image are left out.
  void take_textures(Json& json, std::vector<Texture>& textures) {
    if (json.is_object()) json.erase("extensions");
    for (auto item = json.begin(); item != json.end();) {
      Json& value = *item;
      if (value.is_object() && value.contains("index")) {
        Texture found = texture(value);
        if (!found) {
          item = json.erase(item);
          continue;
        }
        const Json transform = object_in(object_in(value, "extensions"), "KHR_texture_transform");
        value.erase("extensions");
        if (!transform.empty()) value["extensions"]["KHR_texture_transform"] = transform;
        value["index"] = textures.size();
        textures.push_back(std::move(found));
      } else if (value.is_structured()) {
        take_textures(value, textures);
      }
      ++item;
    }
  }

  // What Material has no members for, and texture coordinate sets and transforms as they were
  // written.
  void read_parameters(const Json& json) {
    const Json& surface = object_in(json, "pbrMetallicRoughness");
    for (const auto& [holder, name] : {std::pair(&surface, "baseColorTexture"),
                                       {&surface, "metallicRoughnessTexture"},
                                       {&json, "normalTexture"},
                                       {&json, "occlusionTexture"},
                                       {&json, "emissiveTexture"}}) {
      const Json& info = object_in(*holder, name);
      read_coordinates(name, info);
    }
    for (const auto& [extension, properties] : object_in(json, "extensions").items()) {
      if (extension == "KHR_materials_unlit" || !properties.is_object()) continue;
      for (const auto& [key, value] : properties.items()) {
        read_parameter(shown(extension) + ", " + shown(key), value);
      }
    }
    for (const auto& [key, value] : object_in(json, "extras").items()) {
      read_parameter("extras, " + shown(key), value);
    }
  }

  void read_parameter(const std::string& name, const Json& value) {
    if (value.is_object() && value.contains("index")) {
      parameters_.push_back({name, {}, texture_of(value)});
      read_coordinates(name, value);
      for (const auto& [key, member] : value.items()) {
        if (key != "index" && key != "texCoord" && member.is_number()) {
          parameters_.push_back({name + ", " + shown(key), {member.get<double>()}});
        }
      }
    } else {
      parameters_.push_back(parameter_of(name, value));
    }
  }

  void read_coordinates(const std::string& name, const Json& info) {
    if (const Json set = set_of(info); set != 0 && set.is_number()) {
      parameters_.push_back({name + ", set", {set.get<double>()}});
    }
    const std::string before = name + ", KHR_texture_transform, ";
    for (const auto& [key, value] :
         object_in(object_in(info, "extensions"), "KHR_texture_transform").items()) {
      if (key != "texCoord") read_parameter(before + shown(key), value);
    }
  }

  // The texture coordinate set of a texture.
  static Json set_of(const Json& info) {
    const Json& transform = object_in(object_in(info, "extensions"), "KHR_texture_transform");
    const Json& holder = transform.contains("texCoord") ? transform : info;
    return holder.value("texCoord", Json(0));
  }

  Texture texture(const Json& info) {
    Texture texture;
    if (info.empty()) return texture;
    const Json set = set_of(info);
    if (!set.is_number_integer() || set < 0 || set > kMaxTextureSet) {
      ++of_other_coordinates_;
      return texture;
    }
    if (source_of(info) == nullptr) {
      ++without_image_;
      return texture;
    }
    texture = texture_of(info);
    texture.set = set.get<int>();
    read_transform(object_in(object_in(info, "extensions"), "KHR_texture_transform"), texture);
    return texture;
  }

  void read_transform(const Json& json, Texture& texture) {
    const auto read = [&](const Json& from, double& to) {
      const double value = from.is_number() ? from.get<double>() : 0;
      const double clamped = std::clamp(value, -kMaxTextureTransform, kMaxTextureTransform);
      if (!from.is_number() || clamped != value) ++out_of_range_;
      to = clamped;
    };
    if (json.contains("rotation")) read(json["rotation"], texture.rotation);
    for (const auto& [key, to] :
         {std::pair("scale", &texture.scale), {"offset", &texture.offset}}) {
      if (!json.contains(key)) continue;
      const Json& pair = json[key];
      if (!pair.is_array() || pair.size() != 2) {
        ++out_of_range_;
        continue;
      }
      read(pair[0], to->x());
      read(pair[1], to->y());
    }
  }

  // The image of a texture: PNG or JPEG, else that of an extension; null for none.
  const Json* source_of(const Json& info) const {
    const Json* entry = entry_of(parsed_.look, "textures", member(info, "index"));
    if (entry == nullptr) return nullptr;
    const Json& extensions = object_in(*entry, "extensions");
    for (const Json* from :
         {entry, &object_in(extensions, kWebp), &object_in(extensions, kBasisu)}) {
      const Json& source = member(*from, "source");
      if (source.is_number_unsigned()) return &source;
    }
    return nullptr;
  }

  // The image and sampler of a texture; empty without a usable image.
  Texture texture_of(const Json& info) {
    Texture texture;
    const Json* entry = entry_of(parsed_.look, "textures", member(info, "index"));
    const Json* source = source_of(info);
    if (source == nullptr) return texture;
    texture.image = images_.get(source->get<std::size_t>(), scene_.diagnostics);
    const Json* sampler = entry_of(parsed_.look, "samplers", member(*entry, "sampler"));
    if (sampler == nullptr || !texture) return texture;
    texture.wrap_u = wrap(*sampler, "wrapS");
    texture.wrap_v = wrap(*sampler, "wrapT");
    texture.smooth = member(*sampler, "magFilter") != TINYGLTF_TEXTURE_FILTER_NEAREST;
    return texture;
  }

  static Texture::Wrap wrap(const Json& sampler, const char* key) {
    const Json& found = member(sampler, key);
    if (found == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Texture::Wrap::clamp;
    return found == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Texture::Wrap::mirror
                                                          : Texture::Wrap::repeat;
  }

  // The number clamped to its range.
  float in_range(const Json& number, float usual, float least = 0, float most = 1) {
    const double value = number.is_number() ? number.get<double>() : usual;
    if (!number.is_number() || !(value >= least && value <= most)) ++out_of_range_;
    return static_cast<float>(
        std::clamp<double>(value, static_cast<double>(least), static_cast<double>(most)));
  }

  float factor(const Json& object, const char* key, float usual, float least = 0, float most = 1) {
    const auto found = object.find(key);
    return found == object.end() ? usual : in_range(*found, usual, least, most);
  }

  template <int kCount>
  Eigen::Matrix<float, kCount, 1> factors(const Json& object, const char* key, float usual) {
    Eigen::Matrix<float, kCount, 1> values;
    values.setConstant(usual);
    const auto found = object.find(key);
    if (found == object.end()) return values;
    if (!found->is_array() || found->size() != kCount) {
      ++out_of_range_;
      return values;
    }
    for (int i = 0; i < kCount; ++i) {
      values[i] = in_range((*found)[static_cast<std::size_t>(i)], usual);
    }
    return values;
  }

  void warn(std::string message, std::string hint = {}) {
    gltf::warn(scene_.diagnostics, "gltf-material", std::move(message), std::move(hint));
  }

  // Warns about what was left out, once per file.
  void tell() {
    if (!left_aside_.empty()) {
      std::vector<std::string> names;
      for (const std::string& name : left_aside_) names.push_back(shown(name));
      constexpr std::size_t kMaxNames = 10;
      if (names.size() > kMaxNames) names.resize(kMaxNames);
      warn(fmt::format("the materials use extensions that are ignored: {}", fmt::join(names, ", ")),
           "they may look different in other programs");
    }
    if (of_other_coordinates_ > 0) {
      warn(fmt::format("{} with a texture coordinate set other than 0 to {}: left out",
                       counted(of_other_coordinates_, "texture"), kMaxTextureSet));
    }
    if (without_image_ > 0) {
      gltf::warn(
          scene_.diagnostics, "gltf-picture",
          fmt::format("{} without a usable image: left out", counted(without_image_, "texture")));
    }
    if (out_of_range_ > 0) {
      gltf::warn(
          scene_.diagnostics, "gltf-material-range",
          fmt::format("{} of materials out of range: clamped", counted(out_of_range_, "factor")));
    }
  }

  const ParsedJson& parsed_;
  nodes::Scene& scene_;
  Images images_;
  std::vector<MaterialParameter> parameters_;  // of the material that is read
  std::set<std::string> left_aside_;
  int of_other_coordinates_ = 0, without_image_ = 0, out_of_range_ = 0;
};

}  // namespace

void read_materials(const ParsedJson& parsed, std::span<const std::span<const std::byte>> buffers,
                    const ReadOptions& options, nodes::Scene& scene) {
  MaterialReader(parsed, buffers, options, scene).read();
  const auto count = static_cast<int>(scene.materials.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    for (std::size_t p = 0; p < scene.meshes[m].primitives.size(); ++p) {
      const int material = parsed.model.meshes[m].primitives[p].material;
      if (material >= 0 && material < count) {
        scene.meshes[m].primitives[p].material_index = material;
      }
    }
  }
}

}  // namespace krok::gltf
