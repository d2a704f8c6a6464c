#include "compare/material_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

#include "compare/scene_comparison_internal.h"
#include "math/transform.h"

namespace krok::compare {

namespace {

std::string text_of(float value) {
  return fmt::format("{}", value);
}

template <int N>
std::string text_of(const Eigen::Matrix<float, N, 1>& values) {
  std::string text;
  for (const float value : values) text += (text.empty() ? "" : ", ") + text_of(value);
  return text;
}

std::string text_of(std::span<const double> values) {
  if (values.empty()) return "none";
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "" : ", ") + text_of(static_cast<float>(value));
  }
  return text;
}

double distance(float first, float second) {
  return std::abs(static_cast<double>(first) - static_cast<double>(second));
}

template <int N>
double distance(const Eigen::Matrix<float, N, 1>& first, const Eigen::Matrix<float, N, 1>& second) {
  return (first.template cast<double>() - second.template cast<double>())
      .template lpNorm<Eigen::Infinity>();
}

const char* word_of(Material::Alpha alpha) {
  switch (alpha) {
    case Material::Alpha::mask:
      return "mask";
    case Material::Alpha::blend:
      return "blend";
    case Material::Alpha::opaque:
      break;
  }
  return "opaque";
}

const char* word_of(bool value) {
  return value ? "yes" : "no";
}

bool same_image(const EncodedImage& first, const EncodedImage& second) {
  if (first.bytes.empty() && second.bytes.empty()) return first.path == second.path;
  return first.bytes == second.bytes;
}

class Comparison {
 public:
  Comparison(double tolerance, const ImageDistance& images)
      : tolerance_(tolerance), images_(images) {}

  template <typename Value>
  void number(const char* what, const Value& first, const Value& second) {
    // False for NaN.
    if (distance(first, second) <= tolerance_) return;
    say(fmt::format("{} {} and {}", what, text_of(first), text_of(second)));
  }

  template <typename Value>
  void word(const char* what, Value first, Value second) {
    if (first != second) say(fmt::format("{} {} and {}", what, word_of(first), word_of(second)));
  }

  void texture(std::string_view what, const Texture& first, const Texture& second) {
    if (!first && !second) return;
    if (!first || !second) {
      const char* const article = what.starts_with('o') || what.starts_with('e') ? "an" : "a";
      say(fmt::format("only the {} has {} {} texture", first ? "first" : "second", article, what));
    } else if (const auto other = difference_of(*first.image, *second.image)) {
      say(fmt::format("another {} texture{}", what, *other));
    } else if (first.wrap_u != second.wrap_u || first.wrap_v != second.wrap_v ||
               first.smooth != second.smooth) {
      say(fmt::format("the {} texture has another sampler", what));
    }
  }

  // Numbers of an extension's property.
  void numbers(const std::string& what, std::span<const double> first,
               std::span<const double> second) {
    bool same = first.size() == second.size();
    for (std::size_t i = 0; same && i < first.size(); ++i) {
      same = std::abs(first[i] - second[i]) <= tolerance_;
    }
    if (!same) say(fmt::format("{} {} and {}", what, text_of(first), text_of(second)));
  }

  void text(const std::string& what, const std::string& first, const std::string& second) {
    if (first != second) say(fmt::format("another {}", what));
  }

  std::vector<std::string> result() && { return std::move(phrases_); }

 private:
  void say(std::string phrase) { phrases_.push_back(std::move(phrase)); }

  // nullopt for the same pixels, otherwise how far they are apart, where that is known.
  std::optional<std::string> difference_of(const EncodedImage& first,
                                           const EncodedImage& second) const {
    if (same_image(first, second)) return std::nullopt;
    const std::optional<double> distance = images_ ? images_(first, second) : std::nullopt;
    if (!distance) return std::string();
    if (*distance <= tolerance_) return std::nullopt;
    return fmt::format(", by up to {} of 255", std::lround(255 * *distance));
  }

  double tolerance_;
  const ImageDistance& images_;
  std::vector<std::string> phrases_;
};

// The value of a property that a file does not have. Source: the specifications of the extensions.
std::optional<double> default_of(std::string_view name) {
  struct Default {
    std::string_view property;
    double value;
  };
  constexpr auto kDefaults = std::to_array<Default>({
      {"clearcoatFactor", 0},
      {"clearcoatRoughnessFactor", 0},
      {"transmissionFactor", 0},
      {"diffuseTransmissionFactor", 0},
      {"diffuseTransmissionColorFactor", 1},
      {"sheenColorFactor", 0},
      {"sheenRoughnessFactor", 0},
      {"specularFactor", 1},
      {"specularColorFactor", 1},
      {"ior", 1.5},
      {"iridescenceFactor", 0},
      {"iridescenceIor", 1.3},
      {"iridescenceThicknessMinimum", 100},
      {"iridescenceThicknessMaximum", 400},
      {"emissiveStrength", 1},
      {"thicknessFactor", 0},
      {"attenuationColor", 1},
      {"anisotropyStrength", 0},
      {"anisotropyRotation", 0},
      {"dispersion", 0},
      {"diffuseFactor", 1},
      {"glossinessFactor", 1},
      {"offset", 0},  // KHR_texture_transform
      {"rotation", 0},
      {"scale", 1},
      {"set", 0},    // of a texture's coordinates
      {"color", 1},  // of lights
      {"intensity", 1},
      {"innerConeAngle", 0},
      {"outerConeAngle", kPi / 4},
  });
  const std::size_t comma = name.rfind(", ");
  const std::string_view property = comma == name.npos ? name : name.substr(comma + 2);
  for (const Default& one : kDefaults) {
    if (one.property == property) return one.value;
  }
  return std::nullopt;
}

// The parameter of a name; if there is none, one with the default values.
MaterialParameter parameter_of(std::span<const MaterialParameter> parameters,
                               const MaterialParameter& other) {
  const auto found = std::ranges::find(parameters, other.name, &MaterialParameter::name);
  if (found != parameters.end()) return *found;
  const auto usual = default_of(other.name);
  MaterialParameter none{other.name, {}};
  if (usual) none.values.assign(other.values.size(), *usual);
  return none;
}

}  // namespace

std::vector<std::string> differences(std::span<const MaterialParameter> first,
                                     std::span<const MaterialParameter> second, double tolerance,
                                     const ImageDistance& images) {
  Comparison comparison(tolerance, images);
  const auto add = [&](const MaterialParameter& a, const MaterialParameter& b) {
    comparison.texture(a.name, a.texture, b.texture);
    comparison.numbers(a.name, a.values, b.values);
    comparison.text(a.name, a.text, b.text);
  };
  for (const MaterialParameter& one : first) add(one, parameter_of(second, one));
  for (const MaterialParameter& one : second) {
    if (std::ranges::find(first, one.name, &MaterialParameter::name) == first.end()) {
      add(parameter_of(first, one), one);
    }
  }
  return std::move(comparison).result();
}

std::vector<std::string> differences(const Material& first, const Material& second,
                                     double tolerance, const ImageDistance& images) {
  Comparison comparison(tolerance, images);
  comparison.number("base colour", first.base_color, second.base_color);
  comparison.number("metallic", first.metallic, second.metallic);
  comparison.number("roughness", first.roughness, second.roughness);
  comparison.number("emissive", first.emissive, second.emissive);
  constexpr std::array kTextures = {"base colour", "metallic-roughness", "normal", "occlusion",
                                    "emissive"};
  const auto ours = textures_of(first), theirs = textures_of(second);
  static_assert(kTextures.size() == std::tuple_size_v<decltype(ours)>);
  for (std::size_t i = 0; i < kTextures.size(); ++i) {
    comparison.texture(kTextures[i], *ours[i], *theirs[i]);
  }
  if (first.normal_texture && second.normal_texture) {
    comparison.number("normal scale", first.normal_scale, second.normal_scale);
  }
  if (first.occlusion_texture && second.occlusion_texture) {
    comparison.number("occlusion strength", first.occlusion_strength, second.occlusion_strength);
  }
  comparison.word("alpha", first.alpha, second.alpha);
  if (first.alpha == Material::Alpha::mask && second.alpha == Material::Alpha::mask) {
    comparison.number("alpha cutoff", first.alpha_cutoff, second.alpha_cutoff);
  }
  comparison.word("double sided", first.double_sided, second.double_sided);
  comparison.word("unlit", first.unlit, second.unlit);
  return std::move(comparison).result();
}

// How a material's textures use texture coordinates.

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
