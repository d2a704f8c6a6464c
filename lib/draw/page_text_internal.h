#pragma once

#include <string_view>

// Private to this folder: the page's script and style as one HTML text, made by page/bundle.mjs.

namespace krok::draw {

// Contains "<!--krok-data-->" once, as the placeholder for the data.
std::string_view page_text();

}  // namespace krok::draw
