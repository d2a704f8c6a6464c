#include "scene/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/text.h"
#include "scene/model.h"

namespace krok {

namespace {

// A message for the first factor out of its range, or "".
std::string fault_of(const Material& material) {
  const auto outside = [](float value) { return !(value >= 0.0f && value <= 1.0f); };
  const auto any = [&](const auto& values) {
    return std::any_of(values.data(), values.data() + values.size(), outside);
  };
  const auto out_of_range = [](const char* what) {
    return fmt::format("the {} is not in the range 0 to 1", what);
  };
  if (any(material.base_color)) return out_of_range("base colour");
  if (outside(material.metallic)) return out_of_range("metallic factor");
  if (outside(material.roughness)) return out_of_range("roughness");
  if (outside(material.occlusion_strength)) return out_of_range("occlusion strength");
  if (any(material.emissive)) return out_of_range("emissive colour");
  if (outside(material.alpha_cutoff)) return out_of_range("alpha cutoff");
  const auto is_far = [](const Texture* texture) {
    const double largest =
        std::max({texture->scale.cwiseAbs().maxCoeff(), texture->offset.cwiseAbs().maxCoeff(),
                  std::abs(texture->rotation)});
    return texture->set < 0 || texture->set > kMaxTextureSet || !(largest <= kMaxTextureTransform);
  };
  if (std::ranges::any_of(all_textures_of(material), is_far)) {
    return fmt::format("a texture's set is not 0 to {} or its transform not within +-{}",
                       kMaxTextureSet, kMaxTextureTransform);
  }
  if (!(std::abs(material.normal_scale) <= kMaxNormalScale)) {
    return fmt::format("the normal scale is not within +-{}", kMaxNormalScale);
  }
  return {};
}

}  // namespace

static_assert(kMaxTextureSet + 1 == Model::kMaxCoordinateSets);

Vec2f Texture::at(const Vec2f& coordinates) const {
  const Vec2 scaled = scale.cwiseProduct(coordinates.cast<double>());
  const double c = std::cos(rotation), s = std::sin(rotation);
  return (offset + Vec2(c * scaled.x() + s * scaled.y(), c * scaled.y() - s * scaled.x()))
      .cast<float>();
}

std::array<Texture*, 5> textures_of(Material& material) {
  return {&material.base_color_texture, &material.metallic_roughness_texture,
          &material.normal_texture, &material.occlusion_texture, &material.emissive_texture};
}

std::array<const Texture*, 5> textures_of(const Material& material) {
  return {&material.base_color_texture, &material.metallic_roughness_texture,
          &material.normal_texture, &material.occlusion_texture, &material.emissive_texture};
}

std::vector<const Texture*> all_textures_of(const Material& material) {
  const auto own = textures_of(material);
  std::vector<const Texture*> all(own.begin(), own.end());
  for (const MaterialExtension& extension : material.extensions) {
    for (const Texture& texture : extension.textures) all.push_back(&texture);
  }
  return all;
}

Status check(std::span<const Material> materials) {
  std::unordered_set<std::string_view> seen;
  for (const Material& material : materials) {
    if (!is_name(material.name)) {
      return Error("material-name",
                   "a material's name is empty, too long, not UTF-8 or has a zero byte");
    }
    if (!seen.insert(material.name).second) {
      return Error("material-name",
                   fmt::format("two materials are named '{}'", shown(material.name)));
    }
    std::string fault = fault_of(material);
    if (!std::ranges::all_of(material.shaders, is_utf8)) fault = "a shader's name is not UTF-8";
    if (fault.empty()) continue;
    return Error("material-value", fmt::format("material '{}': {}", shown(material.name), fault));
  }
  return {};
}

const Material* find_material(std::span<const Material> materials, std::string_view name) {
  const auto found = std::ranges::find(materials, name, &Material::name);
  return found == materials.end() ? nullptr : &*found;
}

}  // namespace krok
