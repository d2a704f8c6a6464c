#pragma once

#include <string>
#include <string_view>

#include "core/result.h"

namespace krok::bvh {

// Whether `text` can be a BVH file at all: it begins with HIERARCHY, in any case, after white space
// or a byte-order mark. The error (bvh-kind) says what it looks like instead.
Status check_file_kind(std::string_view text, const std::string& file_name);

}  // namespace krok::bvh
