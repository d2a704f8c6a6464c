#include "formats/material/material_format.h"

#include <fmt/format.h>

#include <map>

#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/json/fields.h"
#include "formats/json/located_json.h"

namespace krok::material {

namespace {

using json::Given;
using JsonKind = json::Value::Kind;

// sRGB to linear. Source: IEC 61966-2-1 (sRGB).
double linear_of(double shown_value) {
  return shown_value <= 0.04045 ? shown_value / 12.92
                                : std::pow((shown_value + 0.055) / 1.055, 2.4);
}

// Defaults of a material with these textures: factors that are not given do not change a texture.
Material with_textures_of(const Material& material) {
  Material usual;
  if (material.base_color_texture) usual.base_color = Vec4f::Ones();
  if (material.metallic_roughness_texture) usual.metallic = usual.roughness = 1.0f;
  if (material.emissive_texture) usual.emissive = Vec3f::Ones();
  return usual;
}

std::vector<double> from_list(const json::Value& value) {
  std::vector<double> numbers;
  for (const json::Value& item : value.items) {
    if (item.kind != JsonKind::number || !(item.number >= 0 && item.number <= 1)) return {};
    numbers.push_back(item.number);
  }
  return numbers;
}

std::vector<double> from_hexadecimal(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return {};
  std::vector<double> numbers;
  for (std::size_t at = 1; at < text.size(); at += 2) {
    const std::size_t high = kDigits.find(ascii_lower(text[at]));
    const std::size_t low = kDigits.find(ascii_lower(text[at + 1]));
    if (high == std::string_view::npos || low == std::string_view::npos) return {};
    const double part = static_cast<double>(16 * high + low) / 255;
    numbers.push_back(at < 7 ? linear_of(part) : part);
  }
  return numbers;
}

// [r, g, b], [r, g, b, a], "#RRGGBB" or "#RRGGBBAA"; of three parts without alpha.
template <typename Color>
json::Kind<Color> color() {
  constexpr std::size_t kParts = Color::RowsAtCompileTime;
  const std::string digits = kParts == 4 ? "{6}([0-9A-Fa-f]{2})?" : "{6}";
  return json::kind<Color>(
             json::schema_of_either(
                 {json::schema_of_list(R"({"type": "number", "minimum": 0, "maximum": 1})", 3,
                                       kParts),
                  R"({"type": "string", "pattern": "^#[0-9A-Fa-f])" + digits + "$\"}"}),
             [](const Given& given, Color& to) -> Status {
               const auto numbers = given.value.kind == JsonKind::string
                                        ? from_hexadecimal(given.value.text)
                                        : from_list(given.value);
               if (numbers.size() < 3 || numbers.size() > kParts) {
                 return given.wrong(fmt::format("{} is not a colour", given.name()),
                                    kParts == 4
                                        ? "write [0.8, 0.4, 0.2], each from 0 to 1 and linear, "
                                          "optionally with alpha as a fourth; or \"#E6AA7C\""
                                        : "write [0.8, 0.4, 0.2], each from 0 to 1 and linear; or "
                                          "\"#E6AA7C\"");
               }
               to.setOnes();
               for (std::size_t i = 0; i < numbers.size(); ++i) {
                 to[static_cast<int>(i)] = static_cast<float>(numbers[i]);
               }
               return {};
             })
      .written([](const Color& of) {
        std::vector<std::string> texts;
        for (int i = 0; i < of.size() && (i < 3 || of[i] != 1.0f); ++i) {
          texts.push_back(shortest(of[i]));
        }
        return json::list_text(texts);
      });
}

const std::string kRange = fmt::format("within +-{}", readable(kMaxTextureTransform));

bool is_near(const json::Value& value) {
  return value.kind == JsonKind::number && std::abs(value.number) <= kMaxTextureTransform;
}

json::Kind<Vec2> pair() {
  return json::kind<Vec2>(json::schema_of_numbers(2),
                          [](const Given& given, Vec2& to) -> Status {
                            if (Status status = given.is(JsonKind::array); !status) return status;
                            const auto& items = given.value.items;
                            if (items.size() != 2 || !is_near(items[0]) || !is_near(items[1])) {
                              return given.wrong(fmt::format("{} is not a list of two numbers {}",
                                                             given.name(), kRange));
                            }
                            to = Vec2(items[0].number, items[1].number);
                            return {};
                          })
      .written([](const Vec2& of) { return json::list_text(std::span(of.data(), 2)); });
}

// In degrees.
json::Kind<double> rotation() {
  return json::kind<double>(R"({"description": "degrees", "type": "number"})",
                            [](const Given& given, double& to) -> Status {
                              if (Status status = given.is(JsonKind::number); !status)
                                return status;
                              to = given.value.number * kRadiansPerDegree;
                              if (is_near(given.value)) return {};
                              return given.wrong(fmt::format("{} is not {}", given.name(), kRange));
                            })
      .written([](double of) { return shortest(of / kRadiansPerDegree); });
}

// Written only if it is not as usual.
template <typename Of, typename Member>
auto unusual(Member Of::*member) {
  return [member](const Of& of) {
    if constexpr (std::is_same_v<Of, Material>) {
      return of.*member != with_textures_of(of).*member;
    } else {
      return of.*member != Of().*member;
    }
  };
}

struct File {
  std::map<std::string, std::size_t> numbers = {};  // of materials, by name
  std::map<std::string, std::shared_ptr<const EncodedImage>> images = {};

  Status read_file(const Given& given, Texture& to) {
    std::string path;
    if (Status status = json::path().read(given, &path); !status) return status;
    std::shared_ptr<const EncodedImage>& image = images[path];
    if (image == nullptr) {
      image = std::make_shared<const EncodedImage>(EncodedImage{{}, path, {}});
    }
    to.image = image;
    return {};
  }

  // A path, or an object with a path.
  json::Kind<Texture> texture() {
    using Wrap = Texture::Wrap;
    const auto wrap = json::choice<Wrap>(
        {{"repeat", Wrap::repeat}, {"clamp", Wrap::clamp}, {"mirror", Wrap::mirror}}, true);
    json::Object<Texture> table;
    table
        .field("file",
               json::kind<Texture>(json::path().schema(),
                                   [this](const Given& given, Texture& to) -> Status {
                                     Status status = given.is(JsonKind::string);
                                     return status ? read_file(given.as(given.what), to) : status;
                                   })
                   .written([](const Texture& of) { return json::in_quotes(of.image->path); }))
        .required();
    table.field("wrap_u", &Texture::wrap_u, wrap).written_if(unusual(&Texture::wrap_u));
    table.field("wrap_v", &Texture::wrap_v, wrap).written_if(unusual(&Texture::wrap_v));
    table.field("smooth", &Texture::smooth, json::boolean()).written_if(unusual(&Texture::smooth));
    table
        .field("set", &Texture::set,
               json::whole(0, kMaxTextureSet,
                           fmt::format("a whole number of 0 to {}", kMaxTextureSet)))
        .written_if(unusual(&Texture::set));
    table.field("scale", &Texture::scale, pair()).written_if(unusual(&Texture::scale));
    table.field("rotation", &Texture::rotation, rotation()).written_if(unusual(&Texture::rotation));
    table.field("offset", &Texture::offset, pair())
        .written_if([](const Texture& of) { return !of.offset.isZero(0); })
        .comment();
    return json::kind<Texture>(json::schema_of_either({json::path().schema(), table.schema()}),
                               [this, table](const Given& given, Texture& to) -> Status {
                                 const std::string what = given.name();
                                 return given.value.kind == JsonKind::string
                                            ? read_file(given.as(what), to)
                                            : table.read(given, &to);
                               })
        .written([table](const Texture& of) -> std::string {
          if (!of) return {};
          Texture plain;
          plain.image = of.image;
          return of == plain ? json::in_quotes(of.image->path) : table.write(&of);
        });
  }

  static void set_defaults(const Given& given, Material& to) {
    const Material usual = with_textures_of(to);
    if (!given.has("base_color")) to.base_color = usual.base_color;
    if (!given.has("metallic")) to.metallic = usual.metallic;
    if (!given.has("roughness")) to.roughness = usual.roughness;
    if (!given.has("emissive")) to.emissive = usual.emissive;
  }

  json::Object<Material> material_table() {
    using Alpha = Material::Alpha;
    json::Object<Material> table;
    const auto factor = [&](std::string_view key, float Material::*member, double min) {
      table.field(key, member, json::single(min, std::abs(min) + (min == 0 ? 1 : 0)))
          .written_if(unusual(member));
    };
    table.lines(6).field("name", &Material::name, json::name()).required();
    table.check([this](const Given& given, Material& to) -> Status {
      const auto [place, added] = numbers.emplace(to.name, numbers.size());
      if (added) return {};
      return given.member("name").error(
          "name", fmt::format("{} has the name '{}' of material {}", given.what, shown(to.name),
                              place->second));
    });
    table.described([](const Material& of) { return fmt::format("'{}'", shown(of.name)); });
    table.field("base_color", &Material::base_color, color<Vec4f>(), "linear, or sRGB")
        .written_if(unusual(&Material::base_color));
    table.field("base_color_texture", &Material::base_color_texture, texture());
    factor("metallic", &Material::metallic, 0);
    factor("roughness", &Material::roughness, 0);
    table.field("metallic_roughness_texture", &Material::metallic_roughness_texture, texture());
    table.field("normal_texture", &Material::normal_texture, texture());
    factor("normal_scale", &Material::normal_scale, -kMaxNormalScale);
    table.field("occlusion_texture", &Material::occlusion_texture, texture());
    factor("occlusion_strength", &Material::occlusion_strength, 0);
    table.field("emissive", &Material::emissive, color<Vec3f>(), "linear, or sRGB")
        .written_if(unusual(&Material::emissive));
    table.field("emissive_texture", &Material::emissive_texture, texture());
    table
        .field(
            "alpha", &Material::alpha,
            json::choice<Alpha>(
                {{"opaque", Alpha::opaque}, {"mask", Alpha::mask}, {"blend", Alpha::blend}}, true))
        .written_if(unusual(&Material::alpha));
    factor("alpha_cutoff", &Material::alpha_cutoff, 0);
    table.field("double_sided", &Material::double_sided, json::boolean())
        .written_if(&Material::double_sided);
    table.field("unlit", &Material::unlit, json::boolean()).written_if(&Material::unlit);
    auto shader = json::text();
    shader.read = [](const Given& given, void* to) -> Status {
      if (given.value.kind != JsonKind::string) {
        return given.wrong(fmt::format("\"shaders\" of {} is not a list of names", given.what));
      }
      *static_cast<std::string*>(to) = given.value.text;
      return {};
    };
    table.field("shaders", &Material::shaders, json::list<std::string>(shader, {"{1}"}))
        .written_if([](const Material& of) { return !of.shaders.empty(); });
    table.check([](const Given& given, Material& to) {
      set_defaults(given, to);
      return Status();
    });
    return table.comment();
  }

  using Materials = std::vector<Material>;
  json::Object<Materials> table() {
    json::Object<Materials> file;
    file.lines(2).file("krok.material/1", "Materials (krok.material/1)").comment();
    file.field("materials", json::list<Material>(json::object(material_table()),
                                                 {"material {0}", 0, 10'000,
                                                  "{0} materials, expected at most {3}", true}))
        .required();
    return file;
  }
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

Result<std::vector<Material>> read(std::string_view text) {
  return File().table().read_text(text, "material");
}

Result<std::string> write(std::span<const Material> materials) {
  if (Status status = check(materials); !status) return status.error();
  for (const Material& material : materials) {
    if (Status status = check_paths(material); !status) return status.error();
  }
  const std::vector<Material> list(materials.begin(), materials.end());
  return File().table().write(&list) + '\n';
}

std::string schema() {
  return File().table().schema();
}

Status load_images(std::span<Material> materials, const OpenImage& open) {
  std::map<std::string, std::shared_ptr<const EncodedImage>> loaded;  // by path
  for (Material& material : materials) {
    for (Texture* texture : textures_of(material)) {
      if (!*texture) continue;
      const std::string& path = texture->image->path;
      std::shared_ptr<const EncodedImage>& image = loaded[path];
      if (image == nullptr) {
        const auto file = open(path);
        if (!file) return file.error();
        auto facts = image_info(file->bytes());
        if (!facts) return std::move(facts.error()).in_file(file->path());
        image = std::make_shared<const EncodedImage>(
            EncodedImage{texture->image->name, path, {file->bytes().begin(), file->bytes().end()}});
      }
      texture->image = image;
    }
  }
  return {};
}

}  // namespace krok::material
