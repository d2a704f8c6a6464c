#include "formats/assimp/fbx_text_internal.h"

#include <algorithm>

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

}  // namespace krok::assimp
