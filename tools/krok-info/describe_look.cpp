#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "core/path_inside.h"
#include "core/text.h"
#include "formats/io/open_character.h"
#include "formats/material/material_format.h"
#include "tools/krok-info/describe.h"

// Materials and characters.

namespace krok::cli::info {

namespace {

// Sizes of the usable images of a file; warns about the others.
class ImageSizes {
 public:
  ImageSizes(std::string path, ToolContext& context) : path_(std::move(path)), context_(context) {}

  // "1024 x 512 PNG", or why it is unusable.
  const std::string& of(const EncodedImage& image) {
    const auto [place, added] = known_.try_emplace(image.path);
    if (added) place->second = look_at(image.path);
    return place->second;
  }

 private:
  std::string look_at(const std::string& name) {
    const auto facts = facts_of(name);
    if (facts) {
      return fmt::format("{} x {} {}", facts->width, facts->height, name_of(facts->kind));
    }
    Diagnostic warning = facts.error();
    warning.severity = Severity::warning;
    const std::string why = warning.message;
    context_.diagnose(std::move(warning));
    return why;
  }

  Result<ImageInfo> facts_of(const std::string& name) {
    auto place = path_inside(folder_of(path_), name);
    if (!place) return std::move(place.error()).in_file(path_);
    const auto file = context_.open_input(*place);
    if (!file) return file.error();
    auto facts = image_info(file->bytes());
    if (!facts) return std::move(facts.error()).in_file(*place);
    return facts;
  }

  const std::string path_;
  ToolContext& context_;
  std::map<std::string, std::string> known_;
};

// "1, 0.8, 0.6".
template <typename Vector>
std::string numbers_of(const Vector& values) {
  std::vector<std::string> texts;
  for (const float value : values) texts.push_back(readable(value, 3));
  return fmt::format("{}", fmt::join(texts, ", "));
}

template <typename Vector>
Json json_of(const Vector& values) {
  Json list = Json::array();
  for (const float value : values) list.push_back(value);
  return list;
}

std::string kind_of(const Material& material) {
  std::string text = material.unlit ? "unlit" : "";
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
  if (!material.unlit) {
    add(fmt::format("metallic {}, roughness {}", readable(material.metallic, 3),
                    readable(material.roughness, 3)));
  }
  if (material.alpha == Material::Alpha::blend) add("transparent");
  if (material.alpha == Material::Alpha::mask) {
    add(fmt::format("cut out below alpha {}", readable(material.alpha_cutoff, 3)));
  }
  if (material.double_sided) add("double-sided");
  if (!material.shaders.empty()) {
    std::vector<std::string> names;
    for (const std::string& name : material.shaders) names.push_back(shown(name));
    add(fmt::format("shaders {}", fmt::join(names, ", ")));
  }
  return text;
}

constexpr std::array<const char*, 5> kTextureNames = {"base colour", "metallic-roughness", "normal",
                                                      "occlusion", "emissive"};

// Colour and kind, and one line per texture.
template <typename SizeOf>
void add_material(const Material& material, SizeOf size_of, Description& out, Json& list) {
  std::vector<std::string> lines = {fmt::format("{}: colour {}; {}", shown(material.name),
                                                numbers_of(material.base_color),
                                                kind_of(material))};
  Json textures = Json::array();
  const auto all = textures_of(material);
  for (std::size_t t = 0; t < all.size(); ++t) {
    if (!*all[t]) continue;
    const EncodedImage& image = *all[t]->image;
    const std::string size = size_of(image);
    lines.push_back(fmt::format("{}: {} ({})", kTextureNames[t], shown(image.path), size));
    textures.push_back({{"of", kTextureNames[t]}, {"file", image.path}, {"picture", size}});
  }
  out.add("material", std::move(lines));
  list.push_back({{"name", material.name},
                  {"base_color", json_of(material.base_color)},
                  {"metallic", material.metallic},
                  {"roughness", material.roughness},
                  {"double_sided", material.double_sided},
                  {"unlit", material.unlit},
                  {"shaders", material.shaders},
                  {"textures", std::move(textures)}});
}

// For a character, with the sizes of images that were read.
void add_materials(std::span<const Material> materials, Description& out) {
  Json list = Json::array();
  const auto size_of = [](const EncodedImage& image) {
    const auto facts = image_info(image.bytes);
    return facts ? fmt::format("{} x {}", facts->width, facts->height) : std::string();
  };
  for (const Material& material : materials) add_material(material, size_of, out, list);
  out.json["materials"] = std::move(list);
}

void add_eyes(const Character& character, Description& out) {
  std::vector<std::string> lines;
  Json list = Json::array();
  for (const Character::Eye& eye : character.eyes) {
    lines.push_back(fmt::format("{} at {} m, on {}", shown(eye.name), numbers_of(eye.position),
                                shown(eye.joint)));
    list.push_back({{"name", eye.name}, {"joint", eye.joint}, {"position", json_of(eye.position)}});
  }
  out.add("eyes", std::move(lines));
  out.json["eyes"] = std::move(list);
  lines.clear();
  for (const Character::Socket& socket : character.sockets) {
    lines.push_back(fmt::format("{} at {} m of {}", shown(socket.name), numbers_of(socket.offset),
                                shown(socket.joint)));
    out.json["sockets"].push_back(
        {{"name", socket.name}, {"joint", socket.joint}, {"offset", json_of(socket.offset)}});
  }
  out.add("sockets", std::move(lines));
}

void add_expressions(const io::LoadedCharacter& loaded, Description& out) {
  Json list = Json::array();
  std::vector<std::string> texts;
  for (std::size_t t = 0; t < loaded.morphs.names.size(); ++t) {
    const std::string& name = loaded.morphs.names[t];
    const float weight = loaded.rest_weights[t];
    texts.push_back(weight == 0 ? shown(name)
                                : fmt::format("{} ({})", shown(name), readable(weight, 3)));
    list.push_back({{"name", name}, {"weight", weight}});
  }
  out.json["expressions"] = std::move(list);
  if (texts.empty()) return;
  constexpr std::size_t kShown = 20;
  const std::string more =
      texts.size() > kShown ? fmt::format(" and {} more", texts.size() - kShown) : "";
  texts.resize(std::min(texts.size(), kShown));
  out.add("expressions", fmt::format("{}{}", fmt::join(texts, ", "), more));
}

}  // namespace

Result<Description> describe_material(const InputFile& file, const SkeletonOptions&,
                                      ToolContext& context) {
  const auto materials = material::read(file.text());
  if (!materials) return materials.error();
  Description out("materials (.material)", "material");
  ImageSizes sizes(file.path(), context);
  Json list = Json::array();
  for (const Material& material : *materials) {
    add_material(
        material, [&](const EncodedImage& image) { return sizes.of(image); }, out, list);
  }
  out.json["materials"] = std::move(list);
  return out;
}

Result<Description> describe_character(const InputFile& file, const SkeletonOptions& how,
                                       ToolContext& context) {
  auto loaded = io::open_character(file, context);
  if (!loaded) return loaded.error();
  const Character& character = loaded->character;
  const Model& model = loaded->model;
  Description out("a character (.character)", "character");
  out.json["name"] = character.name;
  if (!character.name.empty()) out.add("name", shown(character.name));
  out.add("model", fmt::format("{}: {}, {}", shown(character.model),
                               counted(model.positions.size(), "vertex", "vertices"),
                               counted(model.triangles.size(), "triangle")));
  out.json["model"] = character.model;
  out.json["vertices"] = model.positions.size();
  out.json["triangles"] = model.triangles.size();
  add_parts(model, out);
  if (how.mapped) {
    if (Status status = add_skeleton(model.skeleton, how, out); !status) return status.error();
  } else {
    add_skeleton(model.skeleton, loaded->roles, how.verbose, 1, out);
  }
  add_eyes(character, out);
  add_expressions(*loaded, out);
  add_materials(loaded->materials, out);
  io::apply_rest_weights(*loaded);
  add_mesh_size(model, out);
  return out;
}

}  // namespace krok::cli::info
