#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/skeleton.h"

namespace krok::test {

// A skeleton from names with one dot per level, "Hips .Spine ..Head .LeftUpLeg", in the identity
// pose; a name that ends in '!' is an end site.
inline Skeleton skeleton_from_text(std::string_view text) {
  Skeleton skeleton;
  std::vector<int> path;
  while (!text.empty()) {
    const std::size_t begin = text.find_first_not_of(' ');
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(word.size());
    const std::size_t level = word.find_first_not_of('.');
    std::string name(word.substr(level));
    const bool end_site = name.back() == '!';
    if (end_site) name.pop_back();
    path.resize(level);
    path.push_back(skeleton.add(name, level == 0 ? -1 : path[level - 1], {}, end_site));
  }
  return skeleton;
}

}  // namespace krok::test
