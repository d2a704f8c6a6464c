#include "formats/gltf/json_text_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::gltf {

namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 128;
constexpr std::size_t kLongestMessage = 200;

Error at_offset(Error error, const Container& container, std::size_t offset) {
  if (container.binary) {
    return std::move(error).at_byte(static_cast<std::int64_t>(container.json_offset + offset));
  }
  const std::string_view before = container.json.substr(0, offset);
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const std::size_t start = before.rfind('\n');
  const std::size_t column = start == std::string_view::npos ? offset : offset - start - 1;
  return std::move(error).at_line(line, static_cast<std::int64_t>(column) + 1);
}

// The offset at which the text nests too deep, or npos. Checked before parsing, because parsers and
// destructors may recurse.
std::size_t too_deep_at(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kDeepest) return i;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return std::string_view::npos;
}

Result<Json> parse_text(const Container& container) {
  const std::string_view text = container.json;
  if (const std::size_t place = too_deep_at(text); place != std::string_view::npos) {
    return at_offset(Error("gltf-json", fmt::format("the JSON nests deeper than {}", kDeepest),
                           "no exporter writes such files"),
                     container, place);
  }
  try {
    Json json = parse_json_or_throw(text);
    if (json.is_object()) return json;
    return Error("gltf-json", "the JSON is not an object");
  } catch (const Json::parse_error& error) {
    // The message begins "[json.exception...] parse error at line 1, column 5: ".
    std::string what = error.what();
    const std::size_t colon = what.find(": ");
    if (colon != std::string::npos) what = what.substr(colon + 2);
    if (what.size() > kLongestMessage) what = what.substr(0, kLongestMessage) + "...";
    const std::size_t offset = error.byte > 0 ? std::min(error.byte - 1, text.size()) : 0;
    return at_offset(
        Error("gltf-json", "invalid JSON: " + what, "the file is damaged or truncated"), container,
        offset);
  } catch (const Json::exception& error) {
    return Error("gltf-json", fmt::format("unusable JSON: {}", error.what()));
  }
}

// The entries of a list of the file; none if it has no such list.
std::span<const Json> entries_of(const Json& object, const char* list_name) {
  const Json& list = member(object, list_name);
  if (!list.is_array()) return {};
  return list.get_ref<const Json::array_t&>();
}

Status check_asset(const Json& json) {
  const auto asset = json.find("asset");
  if (asset == json.end()) {
    return Error("gltf-version", "there is no 'asset', so this is not glTF 2.0",
                 "glTF 1.0 and other JSON are not supported; convert to glTF 2.0");
  }
  const std::string version = text_member(*asset, "version");
  if (!version.starts_with("2.")) {
    return Error("gltf-version",
                 fmt::format("glTF version '{}', expected 2.0", version.substr(0, 20)),
                 "convert it to glTF 2.0");
  }
  return {};
}

constexpr std::string_view kInstancing = "EXT_mesh_gpu_instancing";
constexpr std::string_view kVisibility = "KHR_node_visibility";
constexpr std::string_view kLights = "KHR_lights_punctual";
constexpr std::string_view kVariants = "KHR_materials_variants";
constexpr std::string_view kPointer = "KHR_animation_pointer";
constexpr std::array<std::string_view, 2> kMeshopt = {"EXT_meshopt_compression",
                                                      "KHR_meshopt_compression"};
constexpr std::string_view kDraco = "KHR_draco_mesh_compression";

bool is_meshopt(std::string_view extension) {
  return std::ranges::find(kMeshopt, extension) != kMeshopt.end();
}

// Extensions that are read, or affect appearance but not geometry.
bool is_supported(std::string_view extension) {
  constexpr std::array kPrefixes = {"KHR_materials_", "KHR_texture_",         "EXT_texture_",
                                    "MSFT_texture_",  "KHR_lights_",          "EXT_lights_",
                                    "KHR_xmp",        "KHR_techniques_webgl", "MSFT_lod"};
  return extension == "KHR_mesh_quantization" || is_meshopt(extension) || extension == kDraco ||
         extension == kInstancing || extension == kVisibility || extension == kPointer ||
         std::any_of(kPrefixes.begin(), kPrefixes.end(),
                     [&](const char* prefix) { return extension.starts_with(prefix); });
}

Status check_extensions(const Json& json) {
  for (const Json& extension : entries_of(json, "extensionsRequired")) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : "?";
    if (is_supported(name)) continue;
    return Error("gltf-extension",
                 fmt::format("the file requires the extension {}, which is not supported",
                             name.substr(0, 80)),
                 "export it without that extension (decompress compressed meshes first)");
  }
  return {};
}

// An extension of an object, if it has it.
const Json* extension_of(const Json& object, std::string_view extension) {
  const Json& found = member(member(object, "extensions"), extension);
  return found.is_object() ? &found : nullptr;
}

// That of meshopt under either of its names.
const Json* meshopt_of(const Json& object) {
  const Json* const first = extension_of(object, kMeshopt[0]);
  return first != nullptr ? first : extension_of(object, kMeshopt[1]);
}

// An unsigned integer; `otherwise` if there is none, an error if it is something else.
Result<std::uint64_t> unsigned_member(const Json& object, const char* name,
                                      std::optional<std::uint64_t> otherwise = {}) {
  const auto found = object.find(name);
  if (found == object.end() && otherwise) return *otherwise;
  if (found != object.end() && found->is_number_unsigned()) return found->get<std::uint64_t>();
  return Error("gltf-structure",
               fmt::format("a compressed buffer view or primitive has no valid '{}'", name));
}

Result<std::vector<PackedView>> read_packed_views(const Json& json) {
  std::vector<PackedView> all;
  const auto views = entries_of(json, "bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Json* source = meshopt_of(views[i]);
    if (source == nullptr) continue;
    PackedView& packed = all.emplace_back();
    packed.view = i;
    packed.mode = text_member(*source, "mode");
    packed.filter = text_member(*source, "filter");
    for (const auto& [name, value, otherwise] :
         {std::tuple("buffer", &packed.buffer, std::optional<std::uint64_t>()),
          {"byteOffset", &packed.offset, 0},
          {"byteLength", &packed.length, {}},
          {"byteStride", &packed.stride, {}},
          {"count", &packed.count, {}}}) {
      const auto read = unsigned_member(*source, name, otherwise);
      if (!read) return read.error();
      *value = *read;
    }
  }
  return all;
}

Result<std::vector<PackedPrimitive>> read_packed_primitives(const Json& json) {
  std::vector<PackedPrimitive> all;
  const auto meshes = entries_of(json, "meshes");
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const auto primitives = entries_of(meshes[m], "primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const Json* source = extension_of(primitives[p], kDraco);
      if (source == nullptr) continue;
      PackedPrimitive& packed = all.emplace_back();
      packed.mesh = m;
      packed.primitive = p;
      const auto view = unsigned_member(*source, "bufferView");
      if (!view) return view.error();
      packed.view = *view;
      const Json& attributes = member(*source, "attributes");
      if (!attributes.is_object()) continue;
      for (const auto& [name, id] : attributes.items()) {
        if (id.is_number_unsigned()) packed.attributes[name] = id.get<std::uint64_t>();
      }
    }
  }
  return all;
}

std::vector<InstancedNode> read_instanced(const Json& json) {
  std::vector<InstancedNode> all;
  const auto nodes = entries_of(json, "nodes");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Json* source = extension_of(nodes[i], kInstancing);
    if (source == nullptr) continue;
    InstancedNode& instanced = all.emplace_back();
    instanced.node = i;
    const Json& attributes = member(*source, "attributes");
    if (!attributes.is_object()) continue;
    for (const auto& [name, accessor] : attributes.items()) {
      const bool fits =
          accessor.is_number_unsigned() && accessor.get<std::uint64_t>() <= 0x7FFFFFFFu;
      instanced.attributes[name] = fits ? accessor.get<int>() : -1;
    }
  }
  return all;
}

// The index in a pointer such as "/nodes/3/rotation"; -1 in others.
int index_between(std::string_view before, std::string_view pointer, std::string_view after) {
  if (!pointer.starts_with(before) || !pointer.ends_with(after)) return -1;
  if (pointer.size() <= before.size() + after.size()) return -1;
  pointer.remove_prefix(before.size());
  pointer.remove_suffix(after.size());
  const auto index = parse_integer(pointer);
  return index && *index >= 0 && *index <= 0x7FFFFFFF ? static_cast<int>(*index) : -1;
}

// Extensions whose data is read. Those of materials are read where they are on materials.
bool is_shown(std::string_view extension) {
  constexpr std::array kOthers = {"KHR_mesh_quantization", "KHR_texture_transform", kWebp, kBasisu,
                                  "KHR_lights_punctual",   "KHR_animation_pointer"};
  const auto is_it = [&](std::string_view other) { return extension == other; };
  return is_meshopt(extension) || is_it(kDraco) || is_it(kInstancing) || is_it(kVisibility) ||
         std::ranges::any_of(kOthers, is_it) || extension.starts_with("KHR_materials_");
}

// The members of an object and of those in it: "light, spot, innerConeAngle". Deeper ones are text,
// so that names take no more than the file does.
void add_members(const std::string& name, const Json& json,
                 std::vector<MaterialParameter>& parameters, int depth = 0) {
  constexpr int kMaxDepth = 3;
  if (!json.is_object() || depth == kMaxDepth) {
    if (!json.is_null()) parameters.push_back(parameter_of(name, json));
    return;
  }
  for (const auto& [key, value] : json.items()) {
    if (key != "name" && key != "extensions") {
      add_members(name + ", " + shown(key), value, parameters, depth + 1);
    }
  }
}

const Json& entry_at(const Json& json, const char* list, const Json& index) {
  static const Json none;
  const auto entries = entries_of(json, list);
  const bool exists = index.is_number_unsigned() && index.get<std::uint64_t>() < entries.size();
  return exists ? entries[index.get<std::size_t>()] : none;
}

std::vector<std::vector<MaterialParameter>> read_node_parameters(const Json& json) {
  std::vector<std::vector<MaterialParameter>> all;
  const Json& lights = member(member(json, "extensions"), kLights);
  for (const Json& node : entries_of(json, "nodes")) {
    auto& parameters = all.emplace_back();
    add_members("camera", entry_at(json, "cameras", member(node, "camera")), parameters);
    const Json& light = member(member(member(node, "extensions"), kLights), "light");
    add_members("light", entry_at(lights, "lights", light), parameters);
  }
  return all;
}

// Names of a file's parts, with a number where one is repeated.
class PartNames {
 public:
  std::string add(const char* kind, std::size_t index, const Json& part) {
    const std::string name = text_member(part, "name");
    std::string text =
        fmt::format("{} {}", kind, name.empty() ? std::to_string(index) : shown(name));
    if (const int number = ++taken_[text]; number > 1) text += fmt::format(" ({})", number);
    return text;
  }

 private:
  std::map<std::string, int> taken_;
};

void add_variants(const Json& json, const std::string& mesh, const Json& primitive,
                  std::vector<MaterialParameter>& properties) {
  const Json& variants = member(member(json, "extensions"), kVariants);
  for (const Json& mapping :
       entries_of(member(member(primitive, "extensions"), kVariants), "mappings")) {
    const Json& material = entry_at(json, "materials", member(mapping, "material"));
    for (const Json& variant : entries_of(mapping, "variants")) {
      const std::string name = text_member(entry_at(variants, "variants", variant), "name");
      properties.push_back({fmt::format("variant {} of {}", shown(name), mesh),
                            {},
                            {},
                            text_member(material, "name")});
    }
  }
}

// Without what Krok writes in extras and reads.
std::vector<MaterialParameter> read_properties(const Json& json) {
  std::vector<MaterialParameter> properties;
  PartNames names;
  for (const auto& [kind, list, own] : {std::tuple("animation", "animations", kRate),
                                        {"node", "nodes", kMark},
                                        {"mesh", "meshes", "targetNames"}}) {
    const auto parts = entries_of(json, list);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string name = names.add(kind, i, parts[i]);
      if (list == std::string_view("meshes")) {
        const auto primitives = entries_of(parts[i], "primitives");
        for (std::size_t p = 0; p < primitives.size(); ++p) {
          add_variants(json, p == 0 ? name : fmt::format("{}, primitive {}", name, p),
                       primitives[p], properties);
        }
      }
      const Json& extras = member(parts[i], "extras");
      if (!extras.is_object()) continue;
      for (const auto& [key, value] : extras.items()) {
        if (key != own) add_members(name + ", " + shown(key), value, properties);
      }
    }
  }
  return properties;
}

std::vector<std::string> read_not_shown(const Json& json, const ParsedJson& parsed) {
  std::vector<std::string> all;
  const auto add = [&](std::int64_t count, const char* one, const char* many) {
    if (count > 0) all.push_back(counted(count, one, many));
  };
  std::int64_t attributes = 0;
  for (const Json& mesh : entries_of(json, "meshes")) {
    for (const Json& primitive : entries_of(mesh, "primitives")) {
      const Json& named = member(primitive, "attributes");
      if (!named.is_object()) continue;
      for (const auto& [name, accessor] : named.items()) {
        const bool more_colours = name.starts_with("COLOR_") && name != "COLOR_0";
        attributes += name.starts_with('_') || more_colours ? 1 : 0;
      }
    }
  }
  add(std::ssize(parsed.pointers), "animation channel of KHR_animation_pointer",
      "animation channels of KHR_animation_pointer");
  add(attributes, "vertex attribute of other names", "vertex attributes of other names");
  for (const Json& extension : entries_of(json, "extensionsUsed")) {
    if (!extension.is_string() || is_shown(extension.get_ref<const std::string&>())) continue;
    all.push_back("extension " + shown(extension.get<std::string>()));
  }
  return all;
}

Result<std::vector<BufferEntry>> read_buffers(const Json& json) {
  std::vector<BufferEntry> buffers;
  const auto list = json.find("buffers");
  if (list == json.end()) return buffers;
  if (!list->is_array()) return Error("gltf-structure", "'buffers' is not an array");
  for (const Json& entry : *list) {
    const Json& length = member(entry, "byteLength");
    if (!length.is_number_unsigned()) {
      return Error("gltf-structure",
                   fmt::format("buffer {} has no valid byteLength", buffers.size()));
    }
    const Json* fallback = meshopt_of(entry);
    buffers.push_back({length.get<std::uint64_t>(), entry.contains("uri"),
                       text_member(entry, "uri"),
                       fallback != nullptr && member(*fallback, "fallback") == true});
  }
  return buffers;
}

// Buffers without data, all of whose views are packed elsewhere, need no mark as fallback.
void mark_fallbacks(const Json& json, std::vector<BufferEntry>& buffers) {
  std::vector<std::size_t> views(buffers.size(), 0), packed(buffers.size(), 0);
  for (const Json& view : entries_of(json, "bufferViews")) {
    const Json& index = member(view, "buffer");
    if (!index.is_number_unsigned() || index.get<std::uint64_t>() >= buffers.size()) continue;
    const auto buffer = index.get<std::uint64_t>();
    ++views[buffer];
    const Json* const source = meshopt_of(view);
    packed[buffer] += source != nullptr ? 1 : 0;
    const Json from = source == nullptr ? Json() : source->value("buffer", Json());
    if (from.is_number_unsigned() && from.get<std::uint64_t>() < buffers.size()) {
      ++views[from.get<std::uint64_t>()];  // it has data
    }
  }
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    if (views[i] > 0 && views[i] == packed[i] && !buffers[i].has_uri) buffers[i].fallback = true;
  }
}

// glTF lets whole numbers have a fraction of zero, section 2.7: 4.0. Numbers of extras stay.
void make_whole(Json& json) {
  if (json.is_number_float()) {
    constexpr double kExact = 9007199254740992;  // 2^53
    const double value = json.get<double>();
    if (value != std::floor(value) || std::abs(value) > kExact) return;
    if (value < 0) {
      json = static_cast<std::int64_t>(value);
    } else {
      json = static_cast<std::uint64_t>(value);
    }
  } else if (json.is_array()) {
    for (Json& part : json) make_whole(part);
  } else if (json.is_object()) {
    for (auto& [key, part] : json.items()) {
      if (key != "extras") make_whole(part);
    }
  }
}

std::vector<std::vector<std::string>> read_target_names(const Json& json) {
  std::vector<std::vector<std::string>> all;
  for (const Json& mesh : entries_of(json, "meshes")) {
    std::vector<std::string>& names = all.emplace_back();
    for (const Json& name : entries_of(member(mesh, "extras"), "targetNames")) {
      names.push_back(name.is_string() ? name.get<std::string>() : std::string());
    }
  }
  return all;
}

// The animated lens, if there is one; only types are checked.
void read_lens(const Json& entry, nodes::Camera& camera) {
  const Json& lens = member(member(entry, "extras"), "fieldsOfView");
  const Json& rate = member(lens, "rate");
  if (!rate.is_number() || !member(lens, "values").is_array()) return;
  camera.lens_rate = rate.get<double>();
  for (const Json& value : entries_of(lens, "values")) {
    camera.lens.push_back(value.is_number() ? static_cast<float>(value.get<double>()) : 0.0f);
  }
}

// Not read by tinygltf, which rejects a whole file if a camera has no clipping planes.
std::vector<nodes::Camera> read_cameras(const Json& json) {
  std::vector<nodes::Camera> cameras;
  for (const Json& entry : entries_of(json, "cameras")) {
    nodes::Camera& camera = cameras.emplace_back();
    camera.name = text_member(entry, "name");
    camera.perspective = text_member(entry, "type") != "orthographic";
    const Json& angle = member(member(entry, "perspective"), "yfov");
    if (!angle.is_number()) continue;
    camera.field_of_view = angle.get<double>();
    read_lens(entry, camera);
  }
  return cameras;
}

// Removes what is not used. The depth is already bounded.
void drop_extras(Json& json) {
  if (json.is_object()) {
    json.erase("extras");
    json.erase("extensions");
  }
  if (json.is_object() || json.is_array()) {
    for (Json& part : json) drop_extras(part);
  }
}

Json take_parts(Json& json, std::initializer_list<const char*> parts) {
  Json taken = Json::object();
  for (const char* part : parts) {
    if (const auto found = json.find(part); found != json.end()) taken[part] = std::move(*found);
  }
  return taken;
}

Json used_parts(Json& json) {
  Json used = take_parts(json, {"asset", "scene", "scenes", "nodes", "meshes", "skins",
                                "animations", "accessors", "bufferViews"});
  drop_extras(used);
  return used;
}

// tinygltf truncates integers to 32 bits, which could turn an invalid index into a valid one.
// Coordinates may be any number; sizes that it reads as 64 bits are checked where they are used.
Status check_integers(const Json& json, bool in_sparse = false) {
  if (json.is_array()) {
    for (const Json& part : json) {
      if (auto ok = check_integers(part, in_sparse); !ok) return ok;
    }
  } else if (json.is_object()) {
    constexpr std::array kNumbers = {"matrix",  "rotation", "scale", "translation",
                                     "weights", "min",      "max"};
    constexpr std::array kSizes = {"byteOffset", "byteLength", "count"};
    const auto is_in = [](const auto& list, const std::string& key) {
      return std::find(list.begin(), list.end(), key) != list.end();
    };
    for (const auto& [key, value] : json.items()) {
      if (is_in(kNumbers, key) || (!in_sparse && is_in(kSizes, key))) continue;
      if (auto ok = check_integers(value, in_sparse || key == "sparse"); !ok) return ok;
    }
  } else if (json.is_number_integer()) {
    const bool fits = json.is_number_unsigned() ? json.get<std::uint64_t>() <= 0x7FFFFFFFu
                                                : json.get<std::int64_t>() >= -1;
    if (!fits) {
      return Error("gltf-structure",
                   fmt::format("the integer {} is out of range", json_text(json)));
    }
  }
  return {};
}

Status check_primitives(const Json& json, const tinygltf::Model& model) {
  const auto meshes = json.find("meshes");
  for (std::size_t i = 0; i < model.meshes.size(); ++i) {
    const std::size_t listed = entries_of((*meshes)[i], "primitives").size();
    if (listed == model.meshes[i].primitives.size() && listed > 0) continue;
    return Error("gltf-structure",
                 fmt::format("mesh {} has no primitives, or one without attributes", i));
  }
  return {};
}

std::string first_line(const std::string& text) {
  const std::string line = text.substr(0, text.find('\n'));
  return line.size() > kLongestMessage ? line.substr(0, kLongestMessage) + "..." : line;
}

}  // namespace

std::vector<PointerChannel> take_pointers(Json& json) {
  std::vector<PointerChannel> all;
  const auto animations = json.find("animations");
  if (animations == json.end() || !animations->is_array()) return all;
  for (std::size_t i = 0; i < animations->size(); ++i) {
    Json& animation = (*animations)[i];
    if (!animation.is_object() || !animation.contains("channels")) continue;
    for (Json& channel : animation["channels"]) {
      if (!channel.is_object() || !channel.contains("target")) continue;
      Json& target = channel["target"];
      const Json* extension = extension_of(target, kPointer);
      if (extension == nullptr) continue;
      const std::string pointer = text_member(*extension, "pointer");
      const std::string path = pointer.substr(pointer.rfind('/') + 1);
      const int node = index_between("/nodes/", pointer, "/" + path);
      if (node >= 0 &&
          (path == "translation" || path == "rotation" || path == "scale" || path == "weights")) {
        target = {{"node", node}, {"path", path}};
        continue;
      }
      const Json& sampler = member(channel, "sampler");
      all.push_back({i, sampler.is_number_integer() ? sampler.get<int>() : -1, pointer,
                     index_between("/cameras/", pointer, "/perspective/yfov")});
    }
  }
  return all;
}

MaterialParameter parameter_of(std::string name, const Json& value) {
  const auto is_number = [](const Json& one) { return one.is_number(); };
  if (value.is_number()) return {std::move(name), {value.get<double>()}};
  if (value.is_array() && !value.empty() && std::ranges::all_of(value, is_number)) {
    return {std::move(name), value.get<std::vector<double>>()};
  }
  return {std::move(name), {}, {}, json_text(value)};
}

const Json& member(const Json& object, std::string_view name) {
  static const Json none;
  if (!object.is_object()) return none;
  const auto found = object.find(name);
  return found == object.end() ? none : *found;
}

std::string text_member(const Json& object, const char* name) {
  const Json& text = member(object, name);
  return text.is_string() ? text.get<std::string>() : std::string();
}

Result<ParsedJson> parse_json(const Container& container) {
  auto parsed = parse_text(container);
  if (!parsed) return parsed.error();
  Json& json = *parsed;
  if (auto ok = check_asset(json); !ok) return ok.error();
  if (auto ok = check_extensions(json); !ok) return ok.error();

  ParsedJson result;
  make_whole(json);
  auto buffers = read_buffers(json);
  if (!buffers) return buffers.error();
  mark_fallbacks(json, *buffers);
  result.buffers = std::move(*buffers);
  for (const Json& node : entries_of(json, "nodes")) {
    result.lights.push_back(extension_of(node, kLights) != nullptr);
    const Json& mark = member(member(node, "extras"), kMark);
    result.marked.push_back(mark == kEye || mark == kSocket);
    const Json* visibility = extension_of(node, kVisibility);
    result.hidden.push_back(visibility != nullptr && member(*visibility, "visible") == false);
  }
  result.instanced = read_instanced(json);
  result.pointers = take_pointers(json);
  for (const Json& animation : entries_of(json, "animations")) {
    const Json& rate = member(member(animation, "extras"), kRate);
    result.rates.push_back(rate.is_number() ? rate.get<double>() : 0);
  }
  result.node_parameters = read_node_parameters(json);
  result.properties = read_properties(json);
  result.not_shown = read_not_shown(json, result);
  auto views = read_packed_views(json);
  if (!views) return views.error();
  result.packed_views = std::move(*views);
  auto primitives = read_packed_primitives(json);
  if (!primitives) return primitives.error();
  result.packed_primitives = std::move(*primitives);
  for (const Json& material : entries_of(json, "materials")) {
    result.material_names.push_back(text_member(material, "name"));
  }
  result.target_names = read_target_names(json);
  result.cameras = read_cameras(json);

  // Those of packed primitives have no buffer view, which tinygltf refuses.
  for (const PackedPrimitive& packed : result.packed_primitives) {
    json["meshes"][packed.mesh]["primitives"][packed.primitive].erase("indices");
  }
  result.look = take_parts(json, {"materials", "textures", "images", "samplers"});
  const Json used = used_parts(json);
  json = Json();
  if (auto ok = check_integers(used); !ok) return ok.error();
  tinygltf::TinyGLTF loader;
  std::string errors, warnings;
  try {
    const std::string text = json_text(used);
    const bool loaded = loader.LoadASCIIFromString(&result.model, &errors, &warnings, text.data(),
                                                   static_cast<unsigned int>(text.size()), "", 0);
    if (!loaded) {
      return Error("gltf-structure", "the file's structure is not glTF 2.0: " + first_line(errors),
                   "run the Khronos glTF validator over it to see all its faults");
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return Error("gltf-structure",
                 "the file's structure is not glTF 2.0: " + first_line(error.what()),
                 "run the Khronos glTF validator over it to see all its faults");
  }
  if (auto ok = check_primitives(used, result.model); !ok) return ok.error();
  return result;
}

}  // namespace krok::gltf
