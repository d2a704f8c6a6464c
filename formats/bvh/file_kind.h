#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"

namespace krok::bvh {

// Start of the hierarchy in a text with other lines before it.
struct HierarchyStart {
  std::size_t offset = 0;  // of HIERARCHY, or of ROOT if HIERARCHY is missing
  long long lines = 0;     // lines of text before it
};

// nullopt if none of the first lines begins with HIERARCHY, or the bytes before it are not text.
std::optional<HierarchyStart> find_start(std::string_view text);

// Checks that `text` can be a BVH file: it begins with HIERARCHY (case-insensitive) after optional
// white space or a byte-order mark. The error (bvh-kind) says what the file looks like instead.
Status check_file_kind(std::string_view text, const std::string& file_name);

}  // namespace krok::bvh
