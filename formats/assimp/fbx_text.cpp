#include "formats/assimp/fbx_text_internal.h"

#include <algorithm>

#include "core/text.h"
#include "formats/assimp/fbx_elements_internal.h"

namespace krok::assimp {

std::vector<double> fbx_target_weights(std::string_view text) {
  std::vector<double> weights;
  const auto elements = fbx_elements(text);
  for (std::size_t e = 0; elements && e < elements->list.size(); ++e) {
    const FbxElement& element = elements->list[e];
    if (element.name == "DeformPercent")
      weights.push_back(elements->number(element.value(0)) / 100);
  }
  return weights;
}

std::size_t fbx_object_count(std::string_view text, std::string_view kind) {
  const auto elements = fbx_elements(text);
  if (!elements) return 0;
  return static_cast<std::size_t>(std::ranges::count(elements->list, kind, &FbxElement::name));
}

std::set<std::string> fbx_limb_names(std::string_view text) {
  constexpr std::string_view kAscii = "\"Model::";
  constexpr std::string_view kBinary("\0\1Model", 7);
  constexpr std::size_t kHeader = 5;  // of a text in a binary file: a letter and its length
  std::set<std::string> names;
  const auto elements = fbx_elements(text);
  for (std::size_t e = 0; elements && e < elements->list.size(); ++e) {
    const FbxElement& element = elements->list[e];
    std::string_view name = element.value(1);
    if (element.name != "Model" || element.value(2).find("LimbNode") == std::string_view::npos) {
      continue;
    }
    if (name.starts_with(kAscii) && name.ends_with('"')) {
      name = name.substr(kAscii.size(), name.size() - kAscii.size() - 1);
    } else if (name.size() >= kHeader + kBinary.size() && name.ends_with(kBinary)) {
      name = name.substr(kHeader, name.size() - kHeader - kBinary.size());
    } else {
      continue;
    }
    names.insert(to_utf8(name));
  }
  return names;
}

}  // namespace krok::assimp
