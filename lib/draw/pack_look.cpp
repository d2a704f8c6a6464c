#include <algorithm>
#include <array>
#include <map>

#include "draw/pack_motion_internal.h"

namespace krok::draw {

namespace {

bool is_unknown_to_browsers(const EncodedImage& image) {
  const auto facts = image_info(image.bytes);
  return facts && facts->kind == ImageKind::ktx2;
}

// Packs materials for three.js (page/src/look.js), and each image once.
class LookPacker {
 public:
  LookPacker(const Model& body, Blob& blob) : body_(body), blob_(blob) {}

  Result<Json> pack(std::span<const Material> materials) {
    Json parts = Json::array();
    for (const Model::Part& part : body_.parts) {
      const auto place = place_of(part.material, materials);
      if (!place) return place.error();
      parts.push_back({{"first", part.first_triangle * 3},
                       {"count", part.triangle_count * 3},
                       {"material", *place}});
    }
    Json look;
    look["parts"] = std::move(parts);
    look["materials"] = std::move(materials_);
    look["pictures"] = std::move(images_);
    if (!body_.texture_coordinates.empty()) {
      Json sets = Json::array({add(body_.texture_coordinates)});
      for (const auto& set : body_.more_texture_coordinates) {
        if (sets.size() < kSets) sets.push_back(add(set));
      }
      look["coordinates"] = std::move(sets);
    }
    if (!body_.colours.empty()) look["colours"] = add(body_.colours);
    return look;
  }

 private:
  static constexpr std::size_t kSets = 4;  // that three.js has names for

  template <typename Vector>
  Json add(const std::vector<Vector>& rows) {
    return blob_.add(std::span(rows.front().data(), rows.size() * Vector::RowsAtCompileTime));
  }

  // Index of the material in the page's list. Unset properties keep their defaults.
  Result<std::size_t> place_of(const std::string& name, std::span<const Material> materials) {
    const auto [at, added] = places_.try_emplace(name, materials_.size());
    if (!added) return at->second;
    static const Material kUsual;
    const Material* const found = find_material(materials, name);
    auto json = to_json(found != nullptr ? *found : kUsual);
    if (!json) return json.error();
    materials_.push_back(std::move(*json));
    return at->second;
  }

  Result<Json> to_json(const Material& material) {
    static constexpr std::array<const char*, 3> kAlphas = {"opaque", "mask", "blend"};
    static constexpr std::array<const char*, 5> kTextures = {"baseColor", "metallicRoughness",
                                                             "normal", "occlusion", "emissive"};
    Json json;
    json["color"] = list(material.base_color);
    json["metallic"] = material.metallic;
    json["roughness"] = material.roughness;
    json["normalScale"] = material.normal_scale;
    json["occlusion"] = material.occlusion_strength;
    json["emissive"] = list(material.emissive);
    json["alpha"] = kAlphas[static_cast<std::size_t>(material.alpha)];
    json["cutoff"] = material.alpha_cutoff;
    json["doubleSided"] = material.double_sided;
    json["unlit"] = material.unlit;
    Json textures = Json::object();
    const auto all = textures_of(material);
    for (std::size_t t = 0; t < all.size() && !body_.texture_coordinates.empty(); ++t) {
      const auto set = static_cast<std::size_t>(all[t]->set);
      if (!*all[t] || is_unknown_to_browsers(*all[t]->image) ||
          set > body_.more_texture_coordinates.size() || set >= kSets)
        continue;
      auto texture = to_json(*all[t]);
      if (!texture) return texture.error();
      textures[kTextures[t]] = std::move(*texture);
    }
    json["textures"] = std::move(textures);
    return json;
  }

  Result<Json> to_json(const Texture& texture) {
    static constexpr std::array<const char*, 3> kWraps = {"repeat", "clamp", "mirror"};
    const auto [at, added] = image_places_.try_emplace(texture.image.get(), images_.size());
    if (added) {
      const auto facts = image_info(texture.image->bytes);
      if (!facts) return facts.error();
      Json image = blob_.add(std::span(texture.image->bytes));
      image["type"] = media_type(facts->kind);
      images_.push_back(std::move(image));
    }
    Json json{{"picture", at->second},
              {"wrapU", kWraps[static_cast<std::size_t>(texture.wrap_u)]},
              {"wrapV", kWraps[static_cast<std::size_t>(texture.wrap_v)]},
              {"smooth", texture.smooth}};
    if (texture.set != 0) json["set"] = texture.set;
    if (texture.transforms()) {
      // Where (0, 0), (1, 0) and (0, 1) come to.
      json["transform"] = {list(texture.at(Vec2f(0, 0))), list(texture.at(Vec2f(1, 0))),
                           list(texture.at(Vec2f(0, 1)))};
    }
    return json;
  }

  template <typename Vector>
  static Json list(const Vector& values) {
    Json numbers = Json::array();
    for (const float value : values) numbers.push_back(value);
    return numbers;
  }

  const Model& body_;
  Blob& blob_;
  Json materials_ = Json::array(), images_ = Json::array();
  std::map<std::string, std::size_t> places_;
  std::map<const EncodedImage*, std::size_t> image_places_;
};

}  // namespace

Result<Json> pack_look(const Model& body, std::span<const Material> materials, Blob& blob) {
  return LookPacker(body, blob).pack(materials);
}

}  // namespace krok::draw
