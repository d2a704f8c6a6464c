#pragma once

#include <cstddef>
#include <span>

namespace krok::render {

// The typeface of labels, DejaVu Sans, as a TrueType file.
std::span<const std::byte> font_file();

}  // namespace krok::render
