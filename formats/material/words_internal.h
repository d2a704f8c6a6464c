#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "scene/material.h"

// Private to this folder: shared by reader and writer.

namespace krok::material {

inline constexpr std::string_view kSchema = "krok.material/1";

template <typename T>
using Word = std::pair<std::string_view, T>;

inline constexpr std::array<Word<Material::Alpha>, 3> kAlphaWords = {
    {{"opaque", Material::Alpha::opaque},
     {"mask", Material::Alpha::mask},
     {"blend", Material::Alpha::blend}}};

inline constexpr std::array<Word<Texture::Wrap>, 3> kWrapWords = {
    {{"repeat", Texture::Wrap::repeat},
     {"clamp", Texture::Wrap::clamp},
     {"mirror", Texture::Wrap::mirror}}};

// Defaults of a material with these textures: factors that are not given do not change a texture.
inline Material with_textures_of(const Material& material) {
  Material usual;
  if (material.base_color_texture) usual.base_color = Vec4f::Ones();
  if (material.metallic_roughness_texture) usual.metallic = usual.roughness = 1.0f;
  if (material.emissive_texture) usual.emissive = Vec3f::Ones();
  return usual;
}

}  // namespace krok::material
