#include <fmt/format.h>

#include <cmath>

#include "formats/container/sections.h"

#include "core/json_internal.h"

namespace krok {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxProvenanceBytes = std::size_t{16} << 20;

// Reads strings from JSON objects; records the first value of the wrong type.
struct JsonTexts {
  std::string trouble;

  std::string text(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    if (!found->is_string()) return note(fmt::format("\"{}\" is not a string", key)), std::string();
    return found->get<std::string>();
  }

  const Json& list(const Json& object, const char* key) {
    static const Json kNothing = Json::array();
    const auto found = object.find(key);
    if (found == object.end()) return kNothing;
    if (!found->is_array()) return note(fmt::format("\"{}\" is not an array", key)), kNothing;
    return *found;
  }

  std::vector<std::string> texts(const Json& object, const char* key) {
    std::vector<std::string> all;
    for (const Json& item : list(object, key)) {
      if (!item.is_string())
        return note(fmt::format("\"{}\" has items that are not strings", key)), all;
      all.push_back(item.get<std::string>());
    }
    return all;
  }

  std::vector<std::pair<std::string, std::string>> pairs(const Json& object, const char* key,
                                                         const char* first, const char* second) {
    std::vector<std::pair<std::string, std::string>> all;
    for (const Json& item : list(object, key)) {
      if (!item.is_object())
        return note(fmt::format("\"{}\" has items that are not objects", key)), all;
      all.emplace_back(text(item, first), text(item, second));
    }
    return all;
  }

  double number(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found == object.end() ? 0 : finite(*found, key);
  }

  // {"velocity": [x, y, z], "turn_rate": angle}
  std::optional<RootMotion> root_motion(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) return std::nullopt;
    if (!found->is_object()) {
      note(fmt::format("\"{}\" is not an object", key));
      return std::nullopt;
    }
    RootMotion motion;
    motion.turn_rate = number(*found, "turn_rate");
    const Json& velocity = list(*found, "velocity");
    if (velocity.size() != 3) note("\"velocity\" is not three numbers");
    for (std::size_t i = 0; i < 3 && velocity.size() == 3; ++i) {
      motion.velocity[static_cast<Eigen::Index>(i)] = finite(velocity[i], "velocity");
    }
    return motion;
  }

  double finite(const Json& value, const char* key) {
    if (value.is_number() && std::isfinite(value.get<double>())) return value.get<double>();
    note(fmt::format("\"{}\" has a value that is not a finite number", key));
    return 0;
  }

  void note(std::string what) {
    if (trouble.empty()) trouble = std::move(what);
  }
};

Json pairs_to_json(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Json list = Json::array();
  for (const auto& [name, value] : pairs) list.push_back({{"name", name}, {"value", value}});
  return list;
}

}  // namespace

Result<std::string> provenance_to_text(const Provenance& provenance) {
  Json json;
  json["schema"] = "krok.provenance/1";
  json["tool"] = provenance.tool;
  json["version"] = provenance.version;
  json["sources"] = Json::array();
  for (const auto& source : provenance.sources) {
    json["sources"].push_back({{"name", source.name}, {"xxh3", source.xxh3}});
  }
  json["options"] = pairs_to_json(provenance.options);
  json["conversions"] = provenance.conversions;
  json["warnings"] = provenance.warnings;
  if (const auto& removed = provenance.removed_root_motion) {
    const Vec3& velocity = removed->velocity;
    json["removed_root_motion"] = {{"velocity", {velocity.x(), velocity.y(), velocity.z()}},
                                   {"turn_rate", removed->turn_rate}};
  }
  // File names may have bytes that are not UTF-8; they become U+FFFD.
  std::string text = json_text(json);
  if (text.size() > kMaxProvenanceBytes) {
    return Error("container-provenance", fmt::format("the provenance has {} bytes, the limit is {}",
                                                     text.size(), kMaxProvenanceBytes));
  }
  return text;
}

Result<Provenance> provenance_from_text(std::string_view text) {
  Provenance provenance;
  const auto fail = [&](std::string message) {
    return Error("container-provenance", fmt::format("the provenance {}", message),
                 "create the file again");
  };
  if (text.size() > kMaxProvenanceBytes) {
    return fail(fmt::format("has {} bytes, the limit is {}", text.size(), kMaxProvenanceBytes));
  }
  const Json json = parse_ordered_json(text);
  if (json.is_discarded() || !json.is_object()) return fail("is not a JSON object");
  JsonTexts reader;
  provenance.tool = reader.text(json, "tool");
  provenance.version = reader.text(json, "version");
  for (auto& [name, xxh3] : reader.pairs(json, "sources", "name", "xxh3")) {
    provenance.sources.push_back({std::move(name), std::move(xxh3)});
  }
  provenance.options = reader.pairs(json, "options", "name", "value");
  provenance.conversions = reader.texts(json, "conversions");
  provenance.warnings = reader.texts(json, "warnings");
  provenance.removed_root_motion = reader.root_motion(json, "removed_root_motion");
  if (!reader.trouble.empty()) return fail(fmt::format("is invalid: {}", reader.trouble));
  return provenance;
}

Status write_provenance(const Provenance& provenance, ContainerWriter& container) {
  const auto text = provenance_to_text(provenance);
  if (!text) return text.error();
  return container.section("META", std::as_bytes(std::span(*text)));
}

Result<Provenance> read_provenance(const ContainerReader& container) {
  const auto section = container.find("META");
  if (!section || section->bytes.empty()) return Provenance();
  auto provenance = provenance_from_text(
      {reinterpret_cast<const char*>(section->bytes.data()), section->bytes.size()});
  if (provenance) return provenance;
  return std::move(provenance.error()).at_byte(static_cast<std::int64_t>(section->offset));
}

}  // namespace krok
