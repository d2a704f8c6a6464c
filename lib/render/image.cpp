#include "render/image.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
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

Vec3f to_light(Colour colour) {
  static const auto table = [] {
    std::array<float, 256> result;
    for (std::size_t i = 0; i < result.size(); ++i) {
      const double value = static_cast<double>(i) / 255.0;
      result[i] = static_cast<float>(value <= 0.04045 ? value / 12.92
                                                      : std::pow((value + 0.055) / 1.055, 2.4));
    }
    return result;
  }();
  return {table[colour.red], table[colour.green], table[colour.blue]};
}

Colour to_colour(const Vec3f& light) {
  const auto channel = [](float value) {
    const double kept = std::clamp(static_cast<double>(value), 0.0, 1.0);
    const double screen =
        kept <= 0.0031308 ? 12.92 * kept : 1.055 * std::pow(kept, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(screen * 255.0));
  };
  return {channel(light.x()), channel(light.y()), channel(light.z())};
}

namespace {

// Frees libpng's state on every path.
struct PngImage {
  png_image image{};
  PngImage() { image.version = PNG_IMAGE_VERSION; }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  ~PngImage() { png_image_free(&image); }

  Error error(const char* code, const char* what) const {
    return Error(code, fmt::format("{}: {}", what, image.message));
  }
};

}  // namespace

Result<std::vector<std::byte>> write_png(const Image& image) {
  constexpr const char* kCode = "png-write";
  constexpr const char* kWhat = "cannot write the image as PNG";
  if (image.width < 1 || image.height < 1) {
    return Error(kCode, "cannot write an empty image as PNG");
  }
  PngImage png;
  png.image.width = static_cast<png_uint_32>(image.width);
  png.image.height = static_cast<png_uint_32>(image.height);
  png.image.format = PNG_FORMAT_RGB;
  std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(png.image));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png.image, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) ==
      0) {
    return png.error(kCode, kWhat);
  }
  bytes.resize(size);
  return bytes;
}

Result<Image> read_png(std::span<const std::byte> bytes, std::size_t most_pixels) {
  constexpr const char* kCode = "png-read";
  constexpr const char* kWhat = "cannot read the data as PNG";
  PngImage png;
  if (png_image_begin_read_from_memory(&png.image, bytes.data(), bytes.size()) == 0) {
    return png.error(kCode, kWhat);
  }
  png.image.format = PNG_FORMAT_RGB;
  const std::size_t pixels = std::size_t{png.image.width} * std::size_t{png.image.height};
  if (pixels > most_pixels) {
    return Error(kCode, fmt::format("the image is too large: {} x {} pixels", png.image.width,
                                    png.image.height));
  }
  Image image(static_cast<int>(png.image.width), static_cast<int>(png.image.height), {});
  const png_color white = {255, 255, 255};
  if (png_image_finish_read(&png.image, &white, image.rgb.data(), 0, nullptr) == 0) {
    return png.error(kCode, kWhat);
  }
  return image;
}

}  // namespace krok::render
