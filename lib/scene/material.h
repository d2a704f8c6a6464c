#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/encoded_image.h"

namespace krok {

inline constexpr float kMaxNormalScale = 1000.0f;
inline constexpr int kMaxTextureSet = 7;
inline constexpr double kMaxTextureTransform = 1e6;  // of scale, radians and offset

// An image mapped to a surface by a set of the model's texture coordinates: u to the right, v down,
// 0 to 1 over the image. Source of the transform: Khronos Group, KHR_texture_transform.
struct Texture {
  enum class Wrap : unsigned char { repeat, clamp, mirror };  // outside 0 .. 1

  std::shared_ptr<const EncodedImage> image;  // null: no texture. Textures may share an image
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  bool smooth = true;  // false: nearest-neighbour magnification
  int set = 0;         // of the model's texture coordinates, 0 .. kMaxTextureSet
  // Coordinates are scaled, turned from u towards -v (counter-clockwise on the image), then moved.
  Vec2 scale = Vec2::Ones();
  double rotation = 0.0;  // radians
  Vec2 offset = Vec2::Zero();

  bool transforms() const { return rotation != 0 || scale != Vec2::Ones() || !offset.isZero(0); }
  Vec2f at(const Vec2f& coordinates) const;  // transformed

  explicit operator bool() const { return image != nullptr; }
  friend bool operator==(const Texture&, const Texture&) = default;  // same image object
};

// An extension of a glTF material that Material has no members for, kept as it came.
struct MaterialExtension {
  std::string name;  // "KHR_materials_clearcoat"
  std::string json;  // an object; the "index" of a texture in it is a place in `textures`
  std::vector<Texture> textures{};
};

// Material properties: glTF's metallic-roughness model. Factors are linear and multiply the
// texture's value, or are used alone without a texture. Defaults: light grey and matt. Source:
// Khronos Group, glTF 2.0 Specification (ISO/IEC 12113), section 3.9.
struct Material {
  enum class Alpha : unsigned char {
    opaque,  // alpha is ignored
    mask,    // drawn where alpha >= alpha_cutoff
    blend    // blended over what is behind
  };

  std::string name;  // is_name(), unique among those of one file

  Vec4f base_color{0.8f, 0.8f, 0.8f, 1.0f};  // red, green, blue, alpha; 0 .. 1
  Texture base_color_texture;                // sRGB and alpha
  float metallic = 0.0f;                     // 0 .. 1
  float roughness = 0.8f;                    // 0 .. 1
  Texture metallic_roughness_texture;        // roughness in green, metallic in blue
  Texture normal_texture;                    // tangent space; 0.5 is 0
  float normal_scale = 1.0f;                 // of its x and y, +-kMaxNormalScale
  Texture occlusion_texture;                 // ambient occlusion in red, 1 is unoccluded
  float occlusion_strength = 1.0f;           // 0 .. 1
  Vec3f emissive = Vec3f::Zero();            // 0 .. 1
  Texture emissive_texture;                  // sRGB

  Alpha alpha = Alpha::opaque;
  float alpha_cutoff = 0.5f;  // 0 .. 1
  bool double_sided = false;  // back faces are drawn too
  bool unlit = false;         // shows base_color, ignoring lights

  // Names of shaders used by other software; kept but not used.
  std::vector<std::string> shaders;

  // Of a glTF file, for another one: not in other formats, and not drawn.
  std::vector<MaterialExtension> extensions{};
  std::string extras{};  // JSON, or empty
};

// All its textures, including empty ones: base colour, metallic-roughness, normal, occlusion,
// emissive.
std::array<Texture*, 5> textures_of(Material& material);
std::array<const Texture*, 5> textures_of(const Material& material);

// The same with those of extensions.
std::vector<const Texture*> all_textures_of(const Material& material);

// Checks everything documented above for the materials of one file. Codes: material-name,
// material-value.
Status check(std::span<const Material> materials);

// The material with this name, or nullptr.
const Material* find_material(std::span<const Material> materials, std::string_view name);

// A property of a glTF file, most of a material, that has no member elsewhere: for comparing files.
struct MaterialParameter {
  std::string name;            // "KHR_materials_clearcoat, clearcoatFactor"
  std::vector<double> values;  // if it is a number or several
  Texture texture{};           // if it is one
  std::string text{};          // of any other property: its JSON
};

}  // namespace krok
