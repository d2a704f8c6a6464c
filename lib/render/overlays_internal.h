#pragma once

#include "render/image.h"
#include "render/renderer_internal.h"
#include "render/sheet.h"
#include "render/text.h"

namespace krok::render {

// A grid on the ground y = 0: lines `step` metres apart at multiples of it, within `reach` metres
// of `centre` along x and z, fading away from there. Each line is drawn in `pieces`.
struct Grid {
  Vec3 centre = Vec3::Zero();
  double step = 1, reach = 10;
  int pieces = 24;
};
void paint_grid(const Projection& projection, const Grid& grid, const Box& clip, Image& image);

// A colour scale with its label and limits, `width` pixels wide and kKey high, at its upper left
// corner.
void paint_colour_key(const ColourKey& key, const Vec2& corner, double width, TextPainter& text,
                      Image& image);

}  // namespace krok::render
