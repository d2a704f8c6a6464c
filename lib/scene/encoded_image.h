#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace krok {

// An encoded image file, passed through without decoding.
struct EncodedImage {
  std::string name;              // for display; may be empty
  std::string path;              // of its file, as written by what refers to it; empty if none
  std::vector<std::byte> bytes;  // of its file; empty if only the path is known
};

// The last two are written as they came: nothing here decodes them.
enum class ImageKind : unsigned char { png, jpeg, webp, ktx2 };

std::string_view name_of(ImageKind kind);       // "PNG"
std::string_view media_type(ImageKind kind);    // "image/png"
std::string_view extension_of(ImageKind kind);  // ".png"

struct ImageInfo {
  ImageKind kind = ImageKind::png;
  int width = 0;  // pixels, 1 .. kMaxPixelsASide
  int height = 0;
};
inline constexpr int kMaxPixelsASide = 32768;

// Reads the header of an image file. Chunks, segments or levels are walked without decoding, which
// detects other file formats, truncated files and sizes out of range (codes picture-kind,
// picture-damaged, picture-size); the pixel data is not checked. Sources: ISO/IEC 15948 (PNG),
// ITU-T T.81 annex B (JPEG), RFC 9649 (WebP), Khronos Group, KTX File Format 2.0.
Result<ImageInfo> image_info(std::span<const std::byte> bytes);

}  // namespace krok
