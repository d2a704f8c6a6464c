#pragma once

#include <string>
#include <string_view>

namespace krok::json {

// A quoted JSON string; bytes that are not UTF-8 become U+FFFD.
std::string in_quotes(std::string_view text);

}  // namespace krok::json
