#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

#include "core/bytes.h"
#include "core/text.h"
#include "formats/morph_exr/exr_input_internal.h"

// Source: OpenEXR File Layout, https://openexr.com/en/latest/OpenEXRFileLayout.html

namespace krok::morph_exr {

namespace {

constexpr std::uint32_t kMagic = 20000630;
constexpr std::uint32_t kExrVersion = 2;
constexpr std::uint32_t kLongNames = 0x400;
constexpr std::size_t kLongestName = 255;
constexpr std::uint32_t kMaxAttributes = 1000;
// Max expansion of deflate, rounded up for small files.
constexpr std::uint64_t kMaxExpansion = 1040;

// Types whose readers use no more memory than the attribute's size. OpenEXR 3.1 reads these without
// looking at the size that the file says: with another one it would take a value for the next name.
struct Type {
  std::string_view name;
  std::uint32_t size = 0;  // bytes; 0: varies
};
constexpr Type kTypes[] = {
    {"box2f", 16},      {"box2i", 16},   {"chlist"},       {"chromaticities", 32},
    {"compression", 1}, {"double", 8},   {"envmap", 1},    {"float", 4},
    {"int", 4},         {"keycode", 28}, {"lineOrder", 1}, {"m33f", 36},
    {"m44f", 64},       {"rational", 8}, {"string"},       {"v2f", 8},
    {"v2i", 8},         {"v3f", 12},     {"stringvector"}, {"v3i", 12},
    {"timecode", 8}};

class Scan {
 public:
  Scan(std::span<const std::byte> file, int bytes_per_texel)
      : file_(file), in_(file), bytes_per_texel_(static_cast<std::uint64_t>(bytes_per_texel)) {}

  Result<HeaderFacts> run() {
    if (in_.read<std::uint32_t>() != kMagic) return fail("not an OpenEXR file");
    const auto version = in_.read<std::uint32_t>();
    if ((version & 0xFF) != kExrVersion || (version & ~(0xFFu | kLongNames)) != 0) {
      return fail("tiled, deep and multi-part files and other OpenEXR versions are not supported",
                  "save it as a single-part scan-line image");
    }
    for (std::uint32_t i = 0; i < kMaxAttributes; ++i) {
      std::string_view name, type;
      if (!take_name(name)) return fail("truncated header");
      if (name.empty()) return finish();
      if (!take_name(type)) return fail("truncated header");
      const auto size = in_.read<std::uint32_t>();
      if (!in_.ok() || size > in_.remaining()) {
        return fail(fmt::format("attribute {} exceeds the file", i));
      }
      if (auto looked = look_at(name, type, in_.take(size)); !looked) return looked.error();
    }
    return fail("the header has more than 1000 attributes");
  }

 private:
  Error fail(const std::string& what, std::string hint = "the file is damaged or truncated") {
    const auto place = static_cast<std::int64_t>(file_.size() - in_.remaining());
    return Error("exr-header", what, std::move(hint)).at_byte(place);
  }

  bool take_name(std::string_view& name) {
    const std::string_view rest(
        reinterpret_cast<const char*>(file_.data()) + (file_.size() - in_.remaining()),
        std::min(in_.remaining(), kLongestName + 1));
    const std::size_t end = rest.find('\0');
    if (end == std::string_view::npos) return false;
    name = rest.substr(0, end);
    in_.take(end + 1);
    return in_.ok();
  }

  // Whether the list of names with 16 bytes each ends, with an empty name, where its value does.
  static bool ends_with_its_channels(std::span<const std::byte> value) {
    const std::string_view text(reinterpret_cast<const char*>(value.data()), value.size());
    for (std::size_t at = 0;;) {
      const std::size_t end = text.find('\0', at);
      if (end == std::string_view::npos || end - at > kLongestName) return false;
      if (end == at) return end + 1 == text.size();
      at = end + 1 + 16;
      if (at > text.size()) return false;
    }
  }

  Status look_at(std::string_view name, std::string_view type, std::span<const std::byte> value) {
    ByteReader in(value);
    const auto* known = std::ranges::find(kTypes, type, &Type::name);
    if (known == std::end(kTypes)) {
      return fail(fmt::format("attribute '{}' has an unsupported type", shown(name)),
                  "save it without previews and custom attributes");
    }
    if (known->size != 0 && value.size() != known->size) {
      return fail(fmt::format("attribute '{}' has {} bytes, its type {} has {}", shown(name),
                              value.size(), type, known->size));
    }
    if (type == "chlist" && !ends_with_its_channels(value)) {
      return fail(fmt::format("the channels of attribute '{}' do not fill its size", shown(name)));
    }
    while (type == "stringvector" && in.ok() && in.remaining() > 0) {
      in.take(in.read<std::uint32_t>());
      if (!in.ok())
        return fail(fmt::format("the strings of attribute '{}' exceed its size", shown(name)));
    }
    if (name == "compression") {
      const auto method = in.read<std::uint8_t>();
      if (in.ok() && method <= 3) return {};
      return fail("the compression must be NO, RLE, ZIPS or ZIP", "save it with ZIP");
    }
    if (name == "dataWindow") {
      const auto left = in.read<std::int32_t>(), top = in.read<std::int32_t>();
      const auto right = in.read<std::int32_t>(), bottom = in.read<std::int32_t>();
      if (!in.ok() || left != 0 || top != 0 || right < 0 || bottom < 0 || right >= (1 << 20) ||
          bottom >= (1 << 20)) {
        return fail("invalid data window for a texture");
      }
      facts_ = {static_cast<std::uint32_t>(right) + 1, static_cast<std::uint32_t>(bottom) + 1};
    }
    return {};
  }

  Result<HeaderFacts> finish() {
    const std::uint64_t texels = std::uint64_t{facts_.width} * facts_.height;
    if (texels == 0) return fail("the header has no data window");
    // Each block of up to 16 lines has an offset and a header, 8 bytes each.
    const std::uint64_t blocks = (facts_.height + 15) / 16;
    if (texels * bytes_per_texel_ > kMaxExpansion * file_.size() || blocks * 16 > file_.size()) {
      return fail(fmt::format("{} by {} texels are not possible in {} bytes", facts_.width,
                              facts_.height, file_.size()));
    }
    return facts_;
  }

  std::span<const std::byte> file_;
  ByteReader in_;
  std::uint64_t bytes_per_texel_;
  HeaderFacts facts_;
};

}  // namespace

Result<HeaderFacts> scan_header(std::span<const std::byte> file, int bytes_per_texel) {
  return Scan(file, bytes_per_texel).run();
}

}  // namespace krok::morph_exr
