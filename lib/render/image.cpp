#include "render/image.h"

#include <algorithm>
#include <cmath>

namespace krok::render {

Image::Image(int wide, int high, Colour fill_colour) : width(wide), height(high) {
  rgb.resize(3 * static_cast<std::size_t>(wide) * static_cast<std::size_t>(high));
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    rgb[i] = fill_colour.red;
    rgb[i + 1] = fill_colour.green;
    rgb[i + 2] = fill_colour.blue;
  }
}

Colour Image::at(int x, int y) const {
  const std::size_t i = place(x, y);
  return {rgb[i], rgb[i + 1], rgb[i + 2]};
}

void Image::set(int x, int y, Colour colour) {
  const std::size_t i = place(x, y);
  rgb[i] = colour.red;
  rgb[i + 1] = colour.green;
  rgb[i + 2] = colour.blue;
}

void Image::blend(int x, int y, Colour colour, double cover) {
  if (x < 0 || y < 0 || x >= width || y >= height || !(cover > 0)) return;
  set(x, y, mixed(at(x, y), colour, cover));
}

namespace {

// The pixel range from `low` to `high`, clipped to `size`; NaN and values out of range are clamped
// to the nearest end.
struct Run {
  int begin = 0, end = 0;
  Run(double low, double high, int size)
      : begin(static_cast<int>(std::clamp(std::floor(low), 0.0, static_cast<double>(size)))),
        end(static_cast<int>(std::clamp(std::ceil(high), 0.0, static_cast<double>(size)))) {}
};

// The fraction of the pixel [i, i + 1] that lies in [low, high].
double overlap(int i, double low, double high) {
  return std::clamp(std::min(i + 1.0, high) - std::max(static_cast<double>(i), low), 0.0, 1.0);
}

}  // namespace

void fill(Image& image, const Box& box, Colour colour, double opacity) {
  const Run columns(box.low.x(), box.high.x(), image.width);
  const Run rows(box.low.y(), box.high.y(), image.height);
  for (int y = rows.begin; y < rows.end; ++y) {
    const double high = overlap(y, box.low.y(), box.high.y());
    for (int x = columns.begin; x < columns.end; ++x) {
      image.blend(x, y, colour, opacity * high * overlap(x, box.low.x(), box.high.x()));
    }
  }
}

void draw_line(Image& image, const Vec2& from, const Vec2& to, double width, Colour colour,
               const Box& clip, double opacity) {
  if (!from.allFinite() || !to.allFinite()) return;
  const Vec2 reach = Vec2::Constant(0.5 * width + 1);
  const Vec2 low = (from.cwiseMin(to) - reach).cwiseMax(clip.low);
  const Vec2 high = (from.cwiseMax(to) + reach).cwiseMin(clip.high);
  const Run columns(low.x(), high.x(), image.width);
  const Run rows(low.y(), high.y(), image.height);
  const Vec2 along = to - from;
  const double squared = along.squaredNorm();
  for (int y = rows.begin; y < rows.end; ++y) {
    for (int x = columns.begin; x < columns.end; ++x) {
      const Vec2 offset = Vec2(x + 0.5, y + 0.5) - from;
      const double part = squared > 0 ? std::clamp(offset.dot(along) / squared, 0.0, 1.0) : 0.0;
      const double distance = (offset - part * along).norm();
      // A line thinner than a pixel is drawn one pixel wide and fainter.
      const double cover = std::clamp(0.5 * std::max(width, 1.0) + 0.5 - distance, 0.0, 1.0);
      image.blend(x, y, colour, opacity * std::min(width, 1.0) * cover);
    }
  }
}

}  // namespace krok::render
