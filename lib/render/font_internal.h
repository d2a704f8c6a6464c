#pragma once

#include <cstddef>
#include <span>

namespace krok::render {

// The label font, DejaVu Sans, as a TrueType file.
std::span<const std::byte> font_file();

}  // namespace krok::render
