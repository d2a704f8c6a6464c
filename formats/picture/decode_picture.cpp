#include "formats/picture/decode_picture.h"

#include <fmt/format.h>

#include "formats/picture/decoders_internal.h"
#include "scene/picture.h"

namespace krok::picture {

Result<Pixels> decode(std::span<const std::byte> file, std::size_t most_pixels) {
  const auto facts = picture_facts(file);
  if (!facts) return facts.error();
  const auto width = static_cast<std::size_t>(facts->width);
  const auto height = static_cast<std::size_t>(facts->height);
  if (width * height > most_pixels) {
    return Error("picture-size",
                 fmt::format("the picture has {} x {} pixels, more than {} in all", width, height,
                             most_pixels),
                 "save it smaller");
  }
  Pixels pixels;
  pixels.width = facts->width;
  pixels.height = facts->height;
  pixels.rgba.resize(width * height * 4);
  const auto decoder = facts->kind == PictureKind::png ? decode_png : decode_jpeg;
  if (Status done = decoder(file, pixels); !done) return done.error();
  return pixels;
}

}  // namespace krok::picture
