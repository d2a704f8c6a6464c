#pragma once

#include <string>
#include <string_view>

namespace krok {

// `text` for XML and HTML, including attributes: UTF-8, with &, <, > and " escaped and '?' in place
// of what printable() replaces (see core/text.h) and of characters that XML does not allow.
std::string to_markup(std::string_view text);

}  // namespace krok
