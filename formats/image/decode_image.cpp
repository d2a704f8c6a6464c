#include "formats/image/decode_image.h"

#include <fmt/format.h>

#include "formats/image/decoders_internal.h"
#include "scene/encoded_image.h"

namespace krok::image {

Result<Pixels> decode(std::span<const std::byte> file, std::size_t most_pixels) {
  const auto facts = image_info(file);
  if (!facts) return facts.error();
  const auto width = static_cast<std::size_t>(facts->width);
  const auto height = static_cast<std::size_t>(facts->height);
  if (width * height > most_pixels) {
    return Error("picture-size",
                 fmt::format("the image has {} x {} pixels, the limit is {} in total", width,
                             height, most_pixels),
                 "reduce its size");
  }
  Pixels pixels;
  pixels.width = facts->width;
  pixels.height = facts->height;
  pixels.rgba.resize(width * height * 4);
  const auto decoder = facts->kind == ImageKind::png ? decode_png : decode_jpeg;
  if (Status status = decoder(file, pixels); !status) return status.error();
  return pixels;
}

}  // namespace krok::image
