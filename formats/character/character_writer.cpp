#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/character/character_format.h"
#include "formats/character/schema_internal.h"
#include "formats/json/json_text.h"

namespace krok::character_file {

namespace {

using json::in_quotes;

Status check_paths(const Character& character) {
  std::vector<std::string> paths = character.materials;
  paths.push_back(character.model);
  if (!character.morphs.empty()) paths.push_back(character.morphs);
  if (!character.role_map.empty()) paths.push_back(character.role_map);
  for (const std::string& path : paths) {
    const std::string fault = path_fault(path);
    if (fault.empty()) continue;
    return Error("character-path", fmt::format("the path '{}' {}", shown(path), fault));
  }
  return {};
}

std::string number(float value) {
  return shortest(value + 0.0f);  // turns -0 into 0
}

// One item per line.
std::string list_of(const std::vector<std::string>& items) {
  return fmt::format("[\n    {}\n  ]", fmt::join(items, ",\n    "));
}

std::string text_of(const Character::Part& part) {
  return fmt::format("{{\"name\": {}, \"material\": {}}}", in_quotes(part.name),
                     in_quotes(part.material));
}

std::string text_of(const Character::Eye& eye) {
  return fmt::format("{{\"name\": {}, \"joint\": {}, \"position\": [{}, {}, {}]}}",
                     in_quotes(eye.name), in_quotes(eye.joint), number(eye.position.x()),
                     number(eye.position.y()), number(eye.position.z()));
}

std::string text_of(const Character::Expression& expression) {
  std::string more;
  if (!expression.target.empty()) {
    more += fmt::format(", \"target\": {}", in_quotes(expression.target));
  }
  if (expression.weight != 0) more += fmt::format(", \"weight\": {}", number(expression.weight));
  return fmt::format("{{\"name\": {}{}}}", in_quotes(expression.name), more);
}

template <typename Item>
void put_list(std::vector<std::string>& lines, std::string_view key,
              const std::vector<Item>& items) {
  if (items.empty()) return;
  std::vector<std::string> texts;
  texts.reserve(items.size());
  for (const Item& item : items) texts.push_back(text_of(item));
  lines.push_back(fmt::format("\"{}\": {}", key, list_of(texts)));
}

}  // namespace

Result<std::string> write(const Character& character) {
  if (Status status = check(character); !status) return status.error();
  if (Status status = check_paths(character); !status) return status.error();
  std::vector<std::string> lines;
  const auto put = [&](std::string_view key, const std::string& text) {
    if (!text.empty()) lines.push_back(fmt::format("\"{}\": {}", key, in_quotes(text)));
  };
  put("schema", std::string(kSchema));
  put("name", character.name);
  put("model", character.model);
  if (!character.materials.empty()) {
    std::vector<std::string> paths;
    for (const std::string& path : character.materials) paths.push_back(in_quotes(path));
    lines.push_back(fmt::format("\"materials\": [{}]", fmt::join(paths, ", ")));
  }
  put_list(lines, "parts", character.parts);
  put_list(lines, "eyes", character.eyes);
  put("morphs", character.morphs);
  put_list(lines, "expressions", character.expressions);
  put("role_map", character.role_map);
  return fmt::format("{{\n  {}\n}}\n", fmt::join(lines, ",\n  "));
}

}  // namespace krok::character_file
