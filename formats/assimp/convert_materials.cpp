#include <assimp/material.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "core/numbers.h"
#include "formats/assimp/conversion_internal.h"

namespace krok::assimp {

namespace {

float unit_part(float value, float usual) {
  return std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : usual;
}

Vec3f unit_color(const aiColor4D& color) {
  return {unit_part(color.r, 0.8f), unit_part(color.g, 0.8f), unit_part(color.b, 0.8f)};
}

Texture::Wrap wrap_of(int mode) {
  if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal) return Texture::Wrap::clamp;
  return mode == aiTextureMapMode_Mirror ? Texture::Wrap::mirror : Texture::Wrap::repeat;
}

// Roughness from a Phong exponent. Source: Walter et al., Microfacet Models for Refraction through
// Rough Surfaces (2007), section 5.2; glTF squares its roughness.
float roughness_of(float exponent) {
  return std::pow(2.0f / (exponent + 2.0f), 0.25f);
}

}  // namespace

std::string material_name(const aiScene& source, unsigned index) {
  if (index >= source.mNumMaterials) return {};
  const aiMaterial& material = *source.mMaterials[index];
  aiString name, image;
  const bool named = material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS;
  const std::string text = named ? to_text(name) : std::string();
  const bool by_assimp = text.empty() || text.starts_with("Texture_");
  if (by_assimp && material.GetTexture(aiTextureType_DIFFUSE, 0, &image) == aiReturn_SUCCESS) {
    std::string path = to_text(image);
    std::replace(path.begin(), path.end(), '\\', '/');
    return base_name(path);
  }
  return text == AI_DEFAULT_MATERIAL_NAME ? std::string() : text;
}

int MaterialBuilder::index_of(unsigned material) {
  if (material >= to_.source.mNumMaterials) return -1;
  aiString name;
  const bool named = to_.source.mMaterials[material]->Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS;
  if (named && to_text(name) == AI_DEFAULT_MATERIAL_NAME) return -1;  // added by Assimp
  const auto [place, added] =
      places_.try_emplace(material, static_cast<int>(to_.scene.materials.size()));
  if (added) {
    Material made = convert(*to_.source.mMaterials[material]);
    made.name = material_name(to_.source, material);
    to_.scene.materials.push_back(std::move(made));
  }
  return place->second;
}

Material MaterialBuilder::convert(const aiMaterial& source) {
  Material material;
  material.base_color_texture =
      first_texture(source, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
  material.normal_texture =
      first_texture(source, {aiTextureType_NORMALS, aiTextureType_NORMAL_CAMERA});
  material.emissive_texture =
      first_texture(source, {aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE});
  material.occlusion_texture =
      first_texture(source, {aiTextureType_AMBIENT_OCCLUSION, aiTextureType_LIGHTMAP});
  for (const aiTextureType type : {aiTextureType_METALNESS, aiTextureType_DIFFUSE_ROUGHNESS}) {
    if (source.GetTextureCount(type) > 0) ++separate_;
  }
  aiColor4D color;
  if (source.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
      source.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) {
    material.base_color.head<3>() = unit_color(color);
  }
  if (source.Get(AI_MATKEY_COLOR_EMISSIVE, color) == aiReturn_SUCCESS) {
    material.emissive = unit_color(color);
  }
  // Many exporters write 0 for opaque, and invisible materials are not useful.
  float number = 1;
  if (source.Get(AI_MATKEY_OPACITY, number) == aiReturn_SUCCESS && number > 0 && number < 0.999f) {
    material.base_color.w() = number;
    material.alpha = Material::Alpha::blend;
  }
  if (source.Get(AI_MATKEY_ROUGHNESS_FACTOR, number) == aiReturn_SUCCESS) {
    material.roughness = unit_part(number, material.roughness);
  } else if (source.Get(AI_MATKEY_SHININESS, number) == aiReturn_SUCCESS && number > 0 &&
             std::isfinite(number)) {
    material.roughness = roughness_of(number);
  }
  if (source.Get(AI_MATKEY_METALLIC_FACTOR, number) == aiReturn_SUCCESS) {
    material.metallic = unit_part(number, 0);
  }
  int flag = 0;
  if (source.Get(AI_MATKEY_TWOSIDED, flag) == aiReturn_SUCCESS) material.double_sided = flag != 0;
  return material;
}

Texture MaterialBuilder::first_texture(const aiMaterial& source,
                                       std::initializer_list<aiTextureType> types) {
  for (const aiTextureType type : types) {
    if (Texture found = texture(source, type)) return found;
  }
  return {};
}

Texture MaterialBuilder::texture(const aiMaterial& source, aiTextureType type) {
  Texture texture;
  aiString path;
  if (source.GetTexture(type, 0, &path) != aiReturn_SUCCESS || path.length == 0) return texture;
  int number = 0;
  if (source.Get(AI_MATKEY_UVWSRC(type, 0), number) == aiReturn_SUCCESS && number != 0) {
    ++other_coordinates_;
    return texture;
  }
  texture.image = image(to_text(path));
  if (source.Get(AI_MATKEY_MAPPINGMODE_U(type, 0), number) == aiReturn_SUCCESS) {
    texture.wrap_u = wrap_of(number);
  }
  if (source.Get(AI_MATKEY_MAPPINGMODE_V(type, 0), number) == aiReturn_SUCCESS) {
    texture.wrap_v = wrap_of(number);
  }
  return texture;
}

std::shared_ptr<const EncodedImage> MaterialBuilder::image(const std::string& path) {
  const auto [place, added] = images_.try_emplace(path);
  if (!added) return place->second;
  EncodedImage image{{}, path, {}};
  if (const aiTexture* inside = to_.source.GetEmbeddedTexture(path.c_str())) {
    // A height other than 0 means raw pixels, which are not supported.
    if (inside->mHeight != 0 || inside->pcData == nullptr) {
      ++undecoded_;
      return nullptr;
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(inside->pcData);
    image.bytes.assign(bytes, bytes + inside->mWidth);
    if (inside->mFilename.length > 0) image.path = to_text(inside->mFilename);
  }
  return place->second = std::make_shared<const EncodedImage>(std::move(image));
}

void MaterialBuilder::report() {
  const auto left_out = [&](std::size_t count, const char* one, const char* what,
                            const char* hint) {
    if (count == 0) return;
    to_.warn("assimp-material",
             fmt::format("{} {}: left out", counted(static_cast<long long>(count), one), what),
             hint);
  };
  left_out(other_coordinates_, "texture", "with a texture coordinate set other than 0", "");
  left_out(undecoded_, "image", "embedded as raw pixels", "");
  left_out(separate_, "texture", "with only metallic or only roughness",
           "glTF combines both in one image: roughness in green, metallic in blue");
}

}  // namespace krok::assimp
