#pragma once

#include <string>

namespace krok {

// `text`, which is UTF-8, with "?" for each control character, which a file may hold in its names
// and which a terminal would obey.
std::string printable(const std::string& text);

}  // namespace krok
