#include "formats/assimp/fbx_text_internal.h"

#include <cstdint>
#include <cstring>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::assimp {

std::vector<double> fbx_target_weights(std::string_view text) {
  constexpr std::string_view kName = "DeformPercent";
  std::vector<double> weights;
  for (std::size_t at = text.find(kName); at != std::string_view::npos;
       at = text.find(kName, at + 1)) {
    std::string_view after = text.substr(at + kName.size());
    if (after.starts_with(':')) {
      after = trimmed(after.substr(1, 64));
      const auto value = parse_finite(after.substr(0, after.find_first_of(" \t\r\n,}")));
      if (value) weights.push_back(*value / 100);
    } else if (after.size() > sizeof(double) && after[0] == 'D') {
      // A node's name is followed by its properties: a type letter and a value each.
      double value = 0;
      std::memcpy(&value, after.data() + 1, sizeof(value));
      if (value > -1e6 && value < 1e6) weights.push_back(value / 100);
    }
  }
  return weights;
}

std::size_t fbx_object_count(std::string_view text, std::string_view kind) {
  std::size_t count = 0;
  for (std::size_t at = text.find(kind); at != std::string_view::npos;
       at = text.find(kind, at + kind.size())) {
    const std::string_view after = text.substr(at + kind.size());
    // ASCII: name, colon, id; binary: length of the name, name, properties with the id first.
    const bool ascii =
        after.size() > 2 && after.starts_with(": ") && after[2] >= '0' && after[2] <= '9';
    const bool binary =
        at > 0 && static_cast<unsigned char>(text[at - 1]) == kind.size() && after.starts_with('L');
    count += ascii || binary ? 1 : 0;
  }
  return count;
}

std::set<std::string> fbx_limb_names(std::string_view text) {
  constexpr std::string_view kLimb = "LimbNode", kAscii = "Model::", kAfterAscii = "\", \"";
  constexpr std::string_view kAfterBinary("\0\1Model", 7);
  constexpr std::size_t kPrefix = 1 + sizeof(std::uint32_t);  // of a binary text: 'S' and its size
  std::set<std::string> names;
  for (std::size_t at = text.find(kLimb); at != std::string_view::npos;
       at = text.find(kLimb, at + kLimb.size())) {
    const std::string_view before = text.substr(0, at);
    if (before.ends_with(kAfterAscii)) {
      std::string_view name = before.substr(0, at - kAfterAscii.size());
      name.remove_prefix(name.rfind('"') + 1);
      if (name.starts_with(kAscii)) names.insert(to_utf8(name.substr(kAscii.size())));
    }
    if (at < kPrefix || !before.substr(0, at - kPrefix).ends_with(kAfterBinary)) continue;
    for (std::size_t size = kAfterBinary.size(); size + 2 * kPrefix <= at; ++size) {
      const std::string_view field = before.substr(at - size - 2 * kPrefix, size + kPrefix);
      std::uint32_t length = 0;
      std::memcpy(&length, field.data() + 1, sizeof(length));
      if (field[0] == 'S' && length == size) {
        names.insert(to_utf8(field.substr(kPrefix, size - kAfterBinary.size())));
      }
      if (size > kLongestName || length == size) break;
    }
  }
  return names;
}

}  // namespace krok::assimp
