#include "formats/assimp/fbx_text_internal.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/assimp/fbx_elements_internal.h"

namespace krok::assimp {

std::vector<double> fbx_target_weights(std::string_view text) {
  std::vector<double> weights;
  const auto elements = fbx_elements(text);
  for (std::size_t e = 0; elements && e < elements->list.size(); ++e) {
    const FbxElement& element = elements->list[e];
    if (element.name == "DeformPercent") {
      weights.push_back(elements->number(element.value(0)) / 100);
    }
  }
  return weights;
}

int fbx_version(std::string_view text) {
  constexpr std::string_view kBinary = "Kaydara FBX Binary  ", kAscii = "FBXVersion:";
  constexpr std::size_t kVersionAt = 23;
  if (text.starts_with(kBinary)) {
    std::uint32_t version = 0;
    if (text.size() < kVersionAt + sizeof version) return 0;
    std::memcpy(&version, text.data() + kVersionAt, sizeof version);
    return static_cast<int>(std::min<std::uint32_t>(version, 100000));
  }
  const std::size_t place = text.substr(0, 4096).find(kAscii);
  if (place == std::string_view::npos) return 0;
  const std::string_view number = text.substr(place + kAscii.size(), 16);
  return static_cast<int>(
      parse_integer(trimmed(number.substr(0, number.find_first_of("\r\n")))).value_or(0));
}

std::size_t fbx_object_count(std::string_view text, std::string_view kind) {
  const auto elements = fbx_elements(text);
  if (!elements) return 0;
  return static_cast<std::size_t>(std::ranges::count(elements->list, kind, &FbxElement::name));
}

std::set<std::string> fbx_limb_names(std::string_view text) {
  std::set<std::string> names;
  const auto elements = fbx_elements(text);
  for (std::size_t e = 0; elements && e < elements->list.size(); ++e) {
    const FbxElement& element = elements->list[e];
    const std::string_view title = element.value(1), kind = element.value(2);
    if (element.name != "Model" || kind.find("LimbNode") == std::string_view::npos) continue;
    // ASCII: "Model::Hips"; binary: a letter, a length, Hips, two bytes, Model.
    const std::size_t begin = elements->word == 0 ? title.find("::") + 2 : 5;
    if (begin > title.size()) continue;
    names.insert(to_utf8(title.substr(begin, title.find_first_of({"\"\0", 2}, begin) - begin)));
  }
  return names;
}

}  // namespace krok::assimp
