#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "compare/scene_comparison_internal.h"

// How a material's textures use texture coordinates.

namespace krok::compare {

namespace {

using MeshMemory = UsedTextures::Memory;

constexpr std::string_view kTransform = ", KHR_texture_transform, ";
constexpr std::string_view kSet = ", set";

// A texture transform; the values of the file, or those of none.
struct Coordinates {
  std::vector<double> offset{0, 0}, scale{1, 1}, rotation{0};

  friend bool operator==(const Coordinates&, const Coordinates&) = default;

  // Source: KHR_texture_transform.
  Vec2f at(const Vec2f& place) const {
    const double c = std::cos(rotation[0]), s = std::sin(rotation[0]);
    const double u = scale[0] * static_cast<double>(place.x());
    const double v = scale[1] * static_cast<double>(place.y());
    return Vec2(offset[0] + c * u + s * v, offset[1] - s * u + c * v).cast<float>();
  }
};

// How each texture of a material uses texture coordinates.
struct TextureUses {
  std::map<std::string, Coordinates, std::less<>> transforms;  // of textures of the first set
  std::vector<bool> sets;                                      // whether one uses it
};

TextureUses uses_of(const Material& material, std::span<const MaterialParameter> parameters) {
  TextureUses uses;
  constexpr std::array kNames = {"baseColorTexture", "metallicRoughnessTexture", "normalTexture",
                                 "occlusionTexture", "emissiveTexture"};
  const auto textures = textures_of(material);
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (*textures[i]) uses.transforms[kNames[i]];
  }
  for (const MaterialParameter& one : parameters) {
    if (one.texture) uses.transforms[one.name];
  }
  uses.sets.assign(1, !uses.transforms.empty());
  for (const MaterialParameter& one : parameters) {
    if (!one.name.ends_with(kSet) || one.values.size() != 1) continue;
    uses.transforms.erase(one.name.substr(0, one.name.size() - kSet.size()));
    const double set = one.values[0];
    if (!(set >= 0 && set < 16)) continue;
    uses.sets.resize(std::max(uses.sets.size(), static_cast<std::size_t>(set) + 1));
    uses.sets[static_cast<std::size_t>(set)] = true;
  }
  for (const MaterialParameter& one : parameters) {
    const std::size_t at = one.name.find(kTransform);
    if (at == std::string::npos) continue;
    const auto texture = uses.transforms.find(one.name.substr(0, at));
    if (texture == uses.transforms.end()) continue;
    const std::string_view key = std::string_view(one.name).substr(at + kTransform.size());
    for (const auto& [name, values] : {std::pair("offset", &texture->second.offset),
                                       {"scale", &texture->second.scale},
                                       {"rotation", &texture->second.rotation}}) {
      if (key == name && one.values.size() == values->size()) *values = one.values;
    }
  }
  return uses;
}

// Where all textures of a material transform the first texture coordinates alike, the transformed
// ones are compared, and the transform is no difference: optimisers trade one for the other.
void apply_transform(const TextureUses& uses, SceneMesh& mesh, MeshMemory& memory) {
  if (uses.transforms.empty() || mesh.texture_coordinates.empty()) return;
  const Coordinates& first = uses.transforms.begin()->second;
  const bool alike =
      std::ranges::all_of(uses.transforms, [&](const auto& one) { return one.second == first; });
  if (!alike || first == Coordinates()) return;
  for (const Vec2f& place : mesh.texture_coordinates) {
    memory.coordinates.push_back(first.at(place));
  }
  std::erase_if(memory.parameters, [&](const MaterialParameter& one) {
    const std::size_t at = one.name.find(kTransform);
    return at != std::string::npos && uses.transforms.contains(one.name.substr(0, at));
  });
}

}  // namespace

UsedTextures::UsedTextures(const Scene& from) : scene(from), memory_(from.meshes.size()) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    SceneMesh& mesh = scene.meshes[i];
    if (mesh.material == nullptr) continue;
    Memory& memory = memory_[i];
    memory.parameters.assign(mesh.material_parameters.begin(), mesh.material_parameters.end());
    const TextureUses uses = uses_of(*mesh.material, memory.parameters);
    memory.used_sets = uses.sets;
    apply_transform(uses, mesh, memory);
    mesh.material_parameters = memory.parameters;
    if (!memory.coordinates.empty()) mesh.texture_coordinates = memory.coordinates;
  }
}

}  // namespace krok::compare
