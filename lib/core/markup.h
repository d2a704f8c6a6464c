#pragma once

#include <string>
#include <string_view>

namespace krok {

// `text` for XML and HTML, including attributes: UTF-8, with &, <, > and " escaped and characters
// that XML does not allow replaced by spaces.
std::string to_markup(std::string_view text);

}  // namespace krok
