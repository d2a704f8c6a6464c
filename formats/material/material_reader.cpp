#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>

#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/members.h"
#include "formats/material/material_format.h"
#include "formats/material/words_internal.h"

namespace krok::material {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::size_t kMaxMaterials = 10'000;

// sRGB to linear. Source: IEC 61966-2-1 (sRGB).
double linear_of(double shown_value) {
  return shown_value <= 0.04045 ? shown_value / 12.92
                                : std::pow((shown_value + 0.055) / 1.055, 2.4);
}

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text), in_(text, "material") {}

  Result<std::vector<Material>> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status = in_.only(*root, kWhole, {"schema", "comment", "materials"}); !status) {
      return status.error();
    }
    if (Status status = in_.has_schema(*root, kWhole, kSchema); !status) return status.error();
    const auto list = in_.get(*root, kWhole, "materials", Kind::array);
    if (!list) return list.error();
    if ((*list)->items.size() > kMaxMaterials) {
      return in_.wrong(**list, fmt::format("{} materials, expected at most {}",
                                           (*list)->items.size(), kMaxMaterials));
    }
    for (const Value& item : (*list)->items) {
      if (Status status = read_material(item); !status) return status.error();
    }
    return std::move(materials_);
  }

 private:
  static constexpr std::string_view kWhole = "the file";

  Status read_material(const Value& item) {
    object_ = &item;
    what_ = fmt::format("material {}", materials_.size());
    material_ = Material();
    if (Status status =
            in_.only(item, what_,
                     {"name", "base_color", "base_color_texture", "metallic", "roughness",
                      "metallic_roughness_texture", "normal_texture", "normal_scale",
                      "occlusion_texture", "occlusion_strength", "emissive", "emissive_texture",
                      "alpha", "alpha_cutoff", "double_sided", "unlit", "shaders", "comment"});
        !status) {
      return status;
    }
    for (const auto part : {&Reader::read_name, &Reader::read_textures, &Reader::read_factors,
                            &Reader::read_alpha, &Reader::read_shaders}) {
      if (Status status = (this->*part)(); !status) return status;
    }
    materials_.push_back(std::move(material_));
    return {};
  }

  Status read_name() {
    const auto name = in_.get(*object_, what_, "name", Kind::string);
    if (!name) return name.error();
    const std::string& text = (*name)->text;
    if (!is_name(text)) {
      return in_.wrong(**name, fmt::format("the name of {} is empty, longer than {} bytes or has a "
                                           "zero byte",
                                           what_, kLongestName));
    }
    if (const auto [place, added] = numbers_.emplace(text, materials_.size()); !added) {
      return json::error_at(
          text_, (*name)->offset, "material-name",
          fmt::format("{} has the name '{}' of material {}", what_, shown(text), place->second));
    }
    material_.name = text;
    what_ = fmt::format("'{}'", shown(text));
    return {};
  }

  Status read_textures() {
    for (const auto& [key, texture] :
         {std::pair{"base_color_texture", &material_.base_color_texture},
          {"metallic_roughness_texture", &material_.metallic_roughness_texture},
          {"normal_texture", &material_.normal_texture},
          {"occlusion_texture", &material_.occlusion_texture},
          {"emissive_texture", &material_.emissive_texture}}) {
      const Value* value = object_->find(key);
      if (value == nullptr) continue;
      if (Status status = read_texture(*value, fmt::format("\"{}\" of {}", key, what_), *texture);
          !status) {
        return status;
      }
    }
    return {};
  }

  // A path, or an object with a path.
  Status read_texture(const Value& value, const std::string& what, Texture& texture) {
    const Value* file = &value;
    if (value.kind != Kind::string) {
      if (Status status = in_.only(value, what,
                                   {"file", "wrap_u", "wrap_v", "smooth", "set", "scale",
                                    "rotation", "offset", "comment"});
          !status) {
        return status;
      }
      const auto found = in_.get(value, what, "file", Kind::string);
      if (!found) return found.error();
      file = *found;
      for (const auto& [key, wrap] :
           {std::pair{"wrap_u", &texture.wrap_u}, {"wrap_v", &texture.wrap_v}}) {
        if (Status status = read_word(value, what, key, kWrapWords, *wrap); !status) return status;
      }
      if (Status status = read_truth(value, what, "smooth", texture.smooth); !status) return status;
      if (Status status = read_coordinates(value, what, texture); !status) return status;
    }
    const auto path = in_.path(*file, what);
    if (!path) return path.error();
    std::shared_ptr<const EncodedImage>& image = images_[*path];
    if (image == nullptr) {
      image = std::make_shared<const EncodedImage>(EncodedImage{{}, *path, {}});
    }
    texture.image = image;
    return {};
  }

  Status read_coordinates(const Value& value, const std::string& what, Texture& texture) {
    const auto set = in_.find(value, what, "set", Kind::number);
    if (!set) return set.error();
    if (*set != nullptr) {
      const double number = (*set)->number;
      if (!(number >= 0 && number <= kMaxTextureSet) || number != std::floor(number)) {
        return in_.wrong(
            **set, fmt::format("\"set\" of {} is {}, expected a whole number of 0 to {}", what,
                               readable(number), kMaxTextureSet));
      }
      texture.set = static_cast<int>(number);
    }
    const auto is_near = [](const Value& one) {
      return one.kind == Kind::number && std::abs(one.number) <= kMaxTextureTransform;
    };
    const auto range = fmt::format("within +-{}", readable(kMaxTextureTransform));
    for (const auto& [key, to] :
         {std::pair{"scale", &texture.scale}, {"offset", &texture.offset}}) {
      const auto pair = in_.find(value, what, key, Kind::array);
      if (!pair) return pair.error();
      if (*pair == nullptr) continue;
      const auto& items = (*pair)->items;
      if (items.size() != 2 || !std::ranges::all_of(items, is_near)) {
        return in_.wrong(
            **pair, fmt::format("\"{}\" of {} is not a list of two numbers {}", key, what, range));
      }
      *to = Vec2(items[0].number, items[1].number);
    }
    const auto rotation = in_.find(value, what, "rotation", Kind::number);
    if (!rotation) return rotation.error();
    if (*rotation == nullptr) return {};
    if (!is_near(**rotation)) {
      return in_.wrong(**rotation, fmt::format("\"rotation\" of {} is not {}", what, range));
    }
    texture.rotation = (*rotation)->number * kRadiansPerDegree;
    return {};
  }

  Status read_factors() {
    const Material usual = with_textures_of(material_);
    material_.base_color = usual.base_color;
    material_.metallic = usual.metallic;
    material_.roughness = usual.roughness;
    material_.emissive = usual.emissive;
    if (Status status = read_color("base_color", material_.base_color); !status) return status;
    Vec4f emissive;
    emissive << material_.emissive, 1.0f;
    if (Status status = read_color("emissive", emissive); !status) return status;
    material_.emissive = emissive.head<3>();
    for (const auto& [key, factor] : {std::pair{"metallic", &material_.metallic},
                                      {"roughness", &material_.roughness},
                                      {"occlusion_strength", &material_.occlusion_strength},
                                      {"alpha_cutoff", &material_.alpha_cutoff}}) {
      if (Status status = read_number(key, 0, 1, *factor); !status) return status;
    }
    return read_number("normal_scale", -kMaxNormalScale, kMaxNormalScale, material_.normal_scale);
  }

  Status read_number(const char* key, double least, double most, float& number) {
    const auto value = in_.find(*object_, what_, key, Kind::number);
    if (!value) return value.error();
    if (*value == nullptr) return {};
    const double found = (*value)->number;
    if (!(found >= least && found <= most)) {
      return in_.wrong(**value, fmt::format("\"{}\" of {} is {}, expected {} to {}", key, what_,
                                            readable(found), readable(least), readable(most)));
    }
    number = static_cast<float>(found);
    return {};
  }

  // [r, g, b], [r, g, b, a], "#RRGGBB" or "#RRGGBBAA"; alpha only for the base colour.
  Status read_color(const char* key, Vec4f& color) {
    const Value* value = object_->find(key);
    if (value == nullptr) return {};
    const bool with_alpha = std::string_view(key) == "base_color";
    const auto numbers =
        value->kind == Kind::string ? from_hexadecimal(value->text) : from_list(*value);
    if (!numbers || (numbers->size() == 4 && !with_alpha)) {
      return in_.wrong(*value, fmt::format("\"{}\" of {} is not a colour", key, what_),
                       with_alpha
                           ? "write [0.8, 0.4, 0.2], each from 0 to 1 and linear, optionally "
                             "with alpha as a fourth; or \"#E6AA7C\""
                           : "write [0.8, 0.4, 0.2], each from 0 to 1 and linear; or "
                             "\"#E6AA7C\"");
    }
    color.w() = 1.0f;
    for (std::size_t i = 0; i < numbers->size(); ++i) {
      color[static_cast<int>(i)] = static_cast<float>((*numbers)[i]);
    }
    return {};
  }

  static std::optional<std::vector<double>> from_list(const Value& value) {
    std::vector<double> numbers;
    if (value.kind != Kind::array) return std::nullopt;
    for (const Value& item : value.items) {
      if (item.kind != Kind::number || !(item.number >= 0 && item.number <= 1)) return std::nullopt;
      numbers.push_back(item.number);
    }
    if (numbers.size() != 3 && numbers.size() != 4) return std::nullopt;
    return numbers;
  }

  static std::optional<std::vector<double>> from_hexadecimal(std::string_view text) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return std::nullopt;
    std::vector<double> numbers;
    for (std::size_t at = 1; at < text.size(); at += 2) {
      const std::size_t high = kDigits.find(ascii_lower(text[at]));
      const std::size_t low = kDigits.find(ascii_lower(text[at + 1]));
      if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
      const double part = static_cast<double>(16 * high + low) / 255;
      numbers.push_back(at < 7 ? linear_of(part) : part);
    }
    return numbers;
  }

  Status read_alpha() {
    if (Status status = read_word(*object_, what_, "alpha", kAlphaWords, material_.alpha);
        !status) {
      return status;
    }
    if (Status status = read_truth(*object_, what_, "double_sided", material_.double_sided);
        !status) {
      return status;
    }
    return read_truth(*object_, what_, "unlit", material_.unlit);
  }

  Status read_truth(const Value& object, std::string_view what, const char* key, bool& truth) {
    const auto value = in_.find(object, what, key, Kind::boolean);
    if (!value) return value.error();
    if (*value != nullptr) truth = (*value)->truth;
    return {};
  }

  template <typename T, std::size_t kCount>
  Status read_word(const Value& object, std::string_view what, const char* key,
                   const std::array<Word<T>, kCount>& words, T& meaning) {
    const auto value = in_.find(object, what, key, Kind::string);
    if (!value) return value.error();
    if (*value == nullptr) return {};
    std::vector<std::string> known;
    for (const auto& [word, means] : words) {
      known.emplace_back(word);
      if ((*value)->text != word) continue;
      meaning = means;
      return {};
    }
    return in_.wrong(**value, fmt::format("\"{}\" of {} is '{}'", key, what, shown((*value)->text)),
                     nearest_hint((*value)->text, known));
  }

  Status read_shaders() {
    const auto list = in_.find(*object_, what_, "shaders", Kind::array);
    if (!list) return list.error();
    if (*list == nullptr) return {};
    for (const Value& item : (*list)->items) {
      if (item.kind != Kind::string) {
        return in_.wrong(item, fmt::format("\"shaders\" of {} is not a list of names", what_));
      }
      material_.shaders.push_back(item.text);
    }
    return {};
  }

  std::string_view text_;
  json::Members in_;
  const Value* object_ = nullptr;  // the material being read
  std::string what_;               // its name for messages
  Material material_;              // what was read of it
  std::vector<Material> materials_;
  std::map<std::string, std::size_t> numbers_;  // of materials, by name
  std::map<std::string, std::shared_ptr<const EncodedImage>> images_;
};

}  // namespace

Result<std::vector<Material>> read(std::string_view text) {
  return Reader(text).read();
}

}  // namespace krok::material
