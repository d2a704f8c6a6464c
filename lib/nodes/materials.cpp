#include "nodes/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "core/text.h"

namespace krok::nodes {

namespace {

constexpr std::size_t kRoomForNumbers = 16;

// The name as valid UTF-8 without zero bytes, truncated to leave room for a number.
std::string usable(const std::string& name) {
  std::string text = to_utf8(name);
  std::erase(text, '\0');
  if (text.size() + kRoomForNumbers <= kLongestName) return text;
  std::size_t end = kLongestName - kRoomForNumbers;
  // Do not cut within a character.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end);
}

}  // namespace

void make_names_unique(std::vector<Material>& materials) {
  std::unordered_set<std::string> taken;
  std::unordered_map<std::string, int> numbers;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    std::string& name = materials[i].name;
    name = usable(name);
    if (name.empty()) name = fmt::format("material_{}", i);
    std::string free = name;
    for (int& number = numbers.try_emplace(name, 1).first->second; !taken.insert(free).second;) {
      free = fmt::format("{}_{}", name, ++number);
    }
    name = std::move(free);
  }
}

}  // namespace krok::nodes
