#pragma once

#include <string>
#include <string_view>

namespace krok::json {

// A text in quotes, as JSON has it; bytes that are not UTF-8 become U+FFFD.
std::string in_quotes(std::string_view text);

}  // namespace krok::json
