#pragma once

#include "render/sheet.h"
#include "render/text.h"

namespace krok::render {

// A colour scale with its label and limits, `width` pixels wide and kKey high, at its upper left
// corner.
void paint_colour_key(const ColourKey& key, const Vec2& corner, double width, TextPainter& text,
                      Image& image);

}  // namespace krok::render
