#pragma once

#include <string>
#include <string_view>

namespace krok {

// `text` as it stands in XML and HTML, in attributes too: UTF-8, with &, <, > and " escaped and a
// space for each character that XML has none of.
std::string to_markup(std::string_view text);

}  // namespace krok
