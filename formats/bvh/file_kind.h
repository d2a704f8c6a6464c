#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"

namespace krok::bvh {

// Where the hierarchy begins in a text that does not begin with it.
struct HierarchyStart {
  std::size_t offset = 0;  // of HIERARCHY, or of ROOT where the text begins with that
  long long lines = 0;     // of text before it
};

// Nothing where no line among the first ones begins with HIERARCHY, or what stands before is no
// text.
std::optional<HierarchyStart> find_start(std::string_view text);

// Whether `text` can be a BVH file at all: it begins with HIERARCHY, in any case, after white space
// or a byte-order mark. The error (bvh-kind) says what it looks like instead.
Status check_file_kind(std::string_view text, const std::string& file_name);

}  // namespace krok::bvh
