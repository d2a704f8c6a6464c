#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "scene/material.h"

// Private to this folder: what reader and writer share.

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

// A material as it is where a file says no more than which textures it has: what a texture shows is
// not darkened by a factor that nobody gave.
inline Material with_textures_of(const Material& material) {
  Material usual;
  if (material.base_color_texture) usual.base_color = Vec4f::Ones();
  if (material.metallic_roughness_texture) usual.metallic = usual.roughness = 1.0f;
  if (material.emissive_texture) usual.emissive = Vec3f::Ones();
  return usual;
}

}  // namespace krok::material
