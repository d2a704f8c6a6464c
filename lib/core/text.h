#pragma once

#include <string_view>

namespace krok {

// Whether `text` is well-formed UTF-8 (RFC 3629): no stray or missing continuation bytes, no
// overlong forms, no surrogates, nothing above U+10FFFF. An empty text is.
bool is_utf8(std::string_view text);

}  // namespace krok
