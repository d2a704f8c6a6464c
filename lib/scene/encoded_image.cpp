#include "scene/encoded_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace krok {

namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Big-endian, as in PNG and JPEG.
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

// Little-endian, as in WebP and KTX.
std::uint64_t little_at(std::string_view text, std::size_t at, int bytes) {
  std::uint64_t number = 0;
  for (int i = bytes - 1; i >= 0; --i) {
    number = number << 8 | static_cast<unsigned char>(text[at + static_cast<std::size_t>(i)]);
  }
  return number;
}

Result<ImageInfo> webp_facts(std::string_view text) {
  constexpr std::size_t kData = 20;  // of the first chunk
  if (text.size() < kData + 10 || little_at(text, 4, 4) > text.size() - 8) {
    return damaged("WebP", "is truncated");
  }
  const auto size = [&](std::size_t at, int bytes, std::uint64_t mask, std::uint64_t more) {
    return static_cast<std::uint32_t>((little_at(text, at, bytes) & mask) + more);
  };
  const std::string_view chunk = text.substr(12, 4);
  constexpr std::uint64_t kSide = 0x3FFF;
  if (chunk == "VP8X") {
    return sized(ImageKind::webp, size(kData + 4, 3, ~0u, 1), size(kData + 7, 3, ~0u, 1));
  }
  if (chunk == "VP8L" && text[kData] == '\x2F') {
    const std::uint64_t both = little_at(text, kData + 1, 4);
    return sized(ImageKind::webp, static_cast<std::uint32_t>((both & kSide) + 1),
                 static_cast<std::uint32_t>((both >> 14 & kSide) + 1));
  }
  if (chunk == "VP8 " && text.substr(kData + 3, 3) == "\x9D\x01\x2A") {
    return sized(ImageKind::webp, size(kData + 6, 2, kSide, 0), size(kData + 8, 2, kSide, 0));
  }
  return damaged("WebP", "does not start with a header");
}

constexpr std::string_view kKtxStart = "\xABKTX 20\xBB\r\n\x1A\n";

Result<ImageInfo> ktx_facts(std::string_view text) {
  constexpr std::size_t kLevels = 80, kLevel = 24;  // bytes: where they are listed, and of each
  if (text.size() < kLevels + kLevel) return damaged("KTX2", "is truncated");
  const std::uint64_t levels = std::max<std::uint64_t>(1, little_at(text, 40, 4));
  if (levels > (text.size() - kLevels) / kLevel) return damaged("KTX2", "is truncated");
  for (std::uint64_t level = 0; level < levels; ++level) {
    const std::size_t at = kLevels + kLevel * static_cast<std::size_t>(level);
    const std::uint64_t begin = little_at(text, at, 8), size = little_at(text, at + 8, 8);
    if (begin > text.size() || size > text.size() - begin) return damaged("KTX2", "is truncated");
  }
  return sized(ImageKind::ktx2, static_cast<std::uint32_t>(little_at(text, 20, 4)),
               static_cast<std::uint32_t>(little_at(text, 24, 4)));
}

struct KindNames {
  std::string_view name, media_type, extension;
};
constexpr std::array<KindNames, 4> kKinds = {{{"PNG", "image/png", ".png"},
                                              {"JPEG", "image/jpeg", ".jpg"},
                                              {"WebP", "image/webp", ".webp"},
                                              {"KTX2", "image/ktx2", ".ktx2"}}};
const KindNames& names_of(ImageKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

}  // namespace

std::string_view name_of(ImageKind kind) {
  return names_of(kind).name;
}
std::string_view media_type(ImageKind kind) {
  return names_of(kind).media_type;
}
std::string_view extension_of(ImageKind kind) {
  return names_of(kind).extension;
}

Result<ImageInfo> image_info(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  if (text.starts_with(kPngStart)) return png_facts(text);
  if (text.starts_with("\xFF\xD8\xFF")) return jpeg_facts(text);
  if (text.starts_with("RIFF") && text.substr(0, 12).ends_with("WEBP")) return webp_facts(text);
  if (text.starts_with(kKtxStart)) return ktx_facts(text);
  return Error(
      "picture-kind",
      bytes.empty() ? "the image file is empty" : "the image is neither PNG nor JPEG, WebP or KTX2",
      "save it as PNG or JPEG, the formats that glTF supports");
}

}  // namespace krok
