#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/json/json_text.h"
#include "formats/material/material_format.h"
#include "formats/material/words_internal.h"

namespace krok::material {

namespace {

using json::in_quotes;

template <typename T, std::size_t kCount>
std::string_view word_of(const std::array<Word<T>, kCount>& words, T meaning) {
  for (const auto& [word, means] : words) {
    if (means == meaning) return word;
  }
  return words[0].first;
}

std::string list_of(std::span<const float> numbers) {
  std::vector<std::string> texts;
  for (const float number : numbers) texts.push_back(shortest(number + 0.0f));  // turns -0 into 0
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string text_of(const Texture& texture) {
  std::string more;
  for (const auto& [key, wrap] :
       {std::pair{"wrap_u", texture.wrap_u}, {"wrap_v", texture.wrap_v}}) {
    if (wrap == Texture::Wrap::repeat) continue;
    more += fmt::format(", \"{}\": \"{}\"", key, word_of(kWrapWords, wrap));
  }
  if (!texture.smooth) more += ", \"smooth\": false";
  if (texture.set != 0) more += fmt::format(", \"set\": {}", texture.set);
  const auto pair = [](const Vec2& values) {
    return fmt::format("[{}, {}]", shortest(values.x() + 0.0), shortest(values.y() + 0.0));
  };
  if (texture.scale != Vec2::Ones()) more += ", \"scale\": " + pair(texture.scale);
  if (texture.rotation != 0) {
    more += ", \"rotation\": " + shortest(texture.rotation / kRadiansPerDegree);
  }
  if (!texture.offset.isZero(0)) more += ", \"offset\": " + pair(texture.offset);
  const std::string path = in_quotes(texture.image->path);
  return more.empty() ? path : fmt::format("{{\"file\": {}{}}}", path, more);
}

class Writer {
 public:
  std::string text_of(const Material& material) {
    const Material usual = with_textures_of(material);
    put("name", in_quotes(material.name));
    if (material.base_color != usual.base_color) {
      const bool opaque = material.base_color.w() == 1.0f;
      put("base_color", list_of({material.base_color.data(), opaque ? 3u : 4u}));
    }
    put("base_color_texture", material.base_color_texture);
    put("metallic", material.metallic, usual.metallic);
    put("roughness", material.roughness, usual.roughness);
    put("metallic_roughness_texture", material.metallic_roughness_texture);
    put("normal_texture", material.normal_texture);
    put("normal_scale", material.normal_scale, usual.normal_scale);
    put("occlusion_texture", material.occlusion_texture);
    put("occlusion_strength", material.occlusion_strength, usual.occlusion_strength);
    if (material.emissive != usual.emissive) {
      put("emissive", list_of({material.emissive.data(), 3}));
    }
    put("emissive_texture", material.emissive_texture);
    if (material.alpha != usual.alpha) {
      put("alpha", fmt::format("\"{}\"", word_of(kAlphaWords, material.alpha)));
    }
    put("alpha_cutoff", material.alpha_cutoff, usual.alpha_cutoff);
    if (material.double_sided) put("double_sided", "true");
    if (material.unlit) put("unlit", "true");
    if (!material.shaders.empty()) {
      std::vector<std::string> names;
      for (const std::string& name : material.shaders) names.push_back(in_quotes(name));
      put("shaders", fmt::format("[{}]", fmt::join(names, ", ")));
    }
    return fmt::format("{{\n      {}\n    }}", fmt::join(lines_, ",\n      "));
  }

 private:
  void put(std::string_view key, const std::string& value) {
    lines_.push_back(fmt::format("\"{}\": {}", key, value));
  }
  void put(std::string_view key, float value, float usual) {
    if (value != usual) put(key, shortest(value + 0.0f));
  }
  void put(std::string_view key, const Texture& texture) {
    if (texture) put(key, material::text_of(texture));
  }

  std::vector<std::string> lines_;
};

Status check_paths(const Material& material) {
  for (const Texture* texture : textures_of(material)) {
    if (!*texture) continue;
    const std::string& path = texture->image->path;
    const std::string fault = path_fault(path);
    if (fault.empty()) continue;
    return Error("material-path", fmt::format("material '{}': the path of a texture, '{}', {}",
                                              shown(material.name), shown(path), fault));
  }
  return {};
}

}  // namespace

Result<std::string> write(std::span<const Material> materials) {
  if (Status status = check(materials); !status) return status.error();
  std::vector<std::string> texts;
  for (const Material& material : materials) {
    if (Status status = check_paths(material); !status) return status.error();
    texts.push_back(Writer().text_of(material));
  }
  const std::string list =
      texts.empty() ? "[]" : fmt::format("[\n    {}\n  ]", fmt::join(texts, ",\n    "));
  return fmt::format("{{\n  \"schema\": \"{}\",\n  \"materials\": {}\n}}\n", kSchema, list);
}

}  // namespace krok::material
