#pragma once

#include <string_view>

// Private to this folder: the page's program and style in one HTML text, made by page/bundle.mjs.

namespace krok::draw {

// Holds "<!--krok-data-->" once, where the data goes.
std::string_view page_text();

}  // namespace krok::draw
