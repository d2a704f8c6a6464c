#include "scene/encoded_image.h"

#include <fmt/format.h>

#include <cstdint>
#include <optional>

namespace krok {

namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Both formats are big-endian.
std::uint32_t number_at(std::string_view text, std::size_t at, int bytes) {
  std::uint32_t number = 0;
  for (int i = 0; i < bytes; ++i) {
    number = number << 8 | static_cast<unsigned char>(text[at + static_cast<std::size_t>(i)]);
  }
  return number;
}

Error damaged(std::string_view kind, std::string_view what) {
  return Error("picture-damaged", fmt::format("the {} image {}", kind, what),
               "the file is damaged or truncated; save it again");
}

Result<ImageInfo> sized(ImageKind kind, std::uint32_t width, std::uint32_t height) {
  const auto most = static_cast<std::uint32_t>(kMaxPixelsASide);
  if (width >= 1 && width <= most && height >= 1 && height <= most) {
    return ImageInfo{kind, static_cast<int>(width), static_cast<int>(height)};
  }
  return Error("picture-size", fmt::format("the image size is {} x {} pixels, expected 1 to {} "
                                           "per side",
                                           width, height, most));
}

constexpr std::string_view kPngStart = "\x89PNG\r\n\x1A\n";

Result<ImageInfo> png_facts(std::string_view text) {
  constexpr std::size_t kFrame = 12;  // of a chunk: length, type, checksum
  constexpr std::size_t kHeader = 13;
  bool has_pixels = false;
  for (std::size_t at = kPngStart.size(); at + kFrame <= text.size();) {
    const std::size_t size = number_at(text, at, 4);
    const std::string_view type = text.substr(at + 4, 4);
    if (size > text.size() - at - kFrame) break;
    const bool first = at == kPngStart.size();
    if (first != (type == "IHDR") || (first && size != kHeader)) {
      return damaged("PNG", "does not start with a header");
    }
    has_pixels = has_pixels || type == "IDAT";
    if (type == "IEND" && has_pixels) {
      const std::size_t header = kPngStart.size() + 8;
      return sized(ImageKind::png, number_at(text, header, 4), number_at(text, header + 4, 4));
    }
    at += kFrame + size;
  }
  return damaged("PNG", "has no end marker");
}

// Whether a marker starts a frame, whose header has the size: SOF0 .. SOF15 except DHT, JPG and
// DAC.
bool begins_frame(std::uint32_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

Result<ImageInfo> jpeg_facts(std::string_view text) {
  constexpr std::uint32_t kScan = 0xDA, kEnd = 0xD9;
  std::optional<ImageInfo> facts;
  for (std::size_t at = 2; at + 4 <= text.size();) {
    if (number_at(text, at, 1) != 0xFF) break;
    const std::uint32_t marker = number_at(text, at + 1, 1);
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    const std::size_t size = number_at(text, at + 2, 2);
    if (marker == kEnd || size < 2 || size > text.size() - at - 2) break;
    if (begins_frame(marker)) {
      if (size < 8) break;
      const auto found =
          sized(ImageKind::jpeg, number_at(text, at + 7, 2), number_at(text, at + 5, 2));
      if (!found) return found;
      facts = *found;
    }
    at += 2 + size;
    if (marker != kScan) continue;
    if (!facts) break;
    if (text.find("\xFF\xD9", at) == std::string_view::npos) break;
    return *facts;
  }
  return damaged("JPEG", "has no end marker");
}

}  // namespace

std::string_view media_type(ImageKind kind) {
  return kind == ImageKind::png ? "image/png" : "image/jpeg";
}

std::string_view extension_of(ImageKind kind) {
  return kind == ImageKind::png ? ".png" : ".jpg";
}

Result<ImageInfo> image_info(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  if (text.starts_with(kPngStart)) return png_facts(text);
  if (text.starts_with("\xFF\xD8\xFF")) return jpeg_facts(text);
  return Error("picture-kind",
               bytes.empty() ? "the image file is empty" : "the image is neither PNG nor JPEG",
               "save it as PNG or JPEG, the formats that glTF supports");
}

}  // namespace krok
