#include "formats/image/decode_image.h"

#include <fmt/format.h>

#include "formats/image/decoders_internal.h"
#include "scene/encoded_image.h"

namespace krok::image {

namespace {

// What the header says, of an image that is not too large.
Result<ImageInfo> checked_info(std::span<const std::byte> file, std::size_t most_pixels) {
  const auto facts = image_info(file);
  if (!facts) return facts.error();
  const auto width = static_cast<std::size_t>(facts->width);
  const auto height = static_cast<std::size_t>(facts->height);
  if (facts->kind != ImageKind::png && facts->kind != ImageKind::jpeg) {
    return Error("picture-kind", fmt::format("the image is {}", name_of(facts->kind)),
                 "save it as PNG or JPEG, which can be shown and compared here");
  }
  if (width * height <= most_pixels) return *facts;
  return Error("picture-size",
               fmt::format("the image has {} x {} pixels, the limit is {} in total", width, height,
                           most_pixels),
               "reduce its size");
}

}  // namespace

Result<Pixels> decode(std::span<const std::byte> file, std::size_t most_pixels) {
  const auto facts = checked_info(file, most_pixels);
  if (!facts) return facts.error();
  Pixels pixels;
  pixels.width = facts->width;
  pixels.height = facts->height;
  pixels.rgba.resize(static_cast<std::size_t>(facts->width) *
                     static_cast<std::size_t>(facts->height) * 4);
  const auto decoder = facts->kind == ImageKind::png ? decode_png : decode_jpeg;
  if (Status status = decoder(file, pixels); !status) return status.error();
  return pixels;
}

Result<GreyPixels> decode_grey(std::span<const std::byte> file, std::size_t most_pixels) {
  const auto facts = checked_info(file, most_pixels);
  if (!facts) return facts.error();
  if (facts->kind != ImageKind::png) {
    return Error("picture-kind", "a JPEG has 8 bits of lossy grey", "use a 16-bit PNG");
  }
  GreyAndAlpha both{facts->width, facts->height, {}};
  const std::size_t count =
      static_cast<std::size_t>(facts->width) * static_cast<std::size_t>(facts->height);
  both.values.resize(2 * count);
  if (Status status = decode_grey_png(file, both); !status) return status.error();
  GreyPixels pixels{facts->width, facts->height, std::vector<std::uint16_t>(count), {}};
  pixels.opacity.resize(both.has_alpha ? count : 0);
  for (std::size_t i = 0; i < count; ++i) {
    pixels.values[i] = both.values[2 * i];
    if (both.has_alpha) pixels.opacity[i] = both.values[2 * i + 1];
  }
  return pixels;
}

}  // namespace krok::image
