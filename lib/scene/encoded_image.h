#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace krok {

// A picture as its file holds it, passed on and never decoded.
struct EncodedImage {
  std::string name;              // for people; may be empty
  std::string path;              // of its file, as whoever names it does; empty where it has none
  std::vector<std::byte> bytes;  // of its file; empty where only the path is known
};

enum class ImageKind : unsigned char { png, jpeg };

std::string_view media_type(ImageKind kind);    // "image/png"
std::string_view extension_of(ImageKind kind);  // ".png"

struct ImageInfo {
  ImageKind kind = ImageKind::png;
  int width = 0;  // pixels, 1 .. kMostPixelsASide
  int height = 0;
};
inline constexpr int kMaxPixelsASide = 32768;

// What a PNG or JPEG file says of itself. Its parts are walked from front to back without looking
// into what they hold, so that one of another kind, cut short or with a size beyond reason is told
// (code picture-kind, picture-damaged, picture-size); whether the pixels decode is not known.
// Sources: ISO/IEC 15948 (PNG), ITU-T T.81 annex B (JPEG).
Result<ImageInfo> image_info(std::span<const std::byte> bytes);

}  // namespace krok
