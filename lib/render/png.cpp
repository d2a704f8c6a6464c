#include "render/image.h"

#include <fmt/format.h>
#include <png.h>

namespace krok::render {

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
