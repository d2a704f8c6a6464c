#include "formats/morph_exr/morph_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfStringVectorAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <iterator>
#include <new>
#include <string>
#include <string_view>

#include "core/bytes.h"
#include "core/text.h"
#include "formats/container/sections.h"
#include "formats/morph_exr/exr_input_internal.h"

namespace krok::morph_exr {

namespace {

constexpr int kMorphVersion = 1;
constexpr std::uint64_t kMaxWidth = 16384;
constexpr std::uint64_t kMaxRows = 16384;  // of a half
constexpr const char* kChannels[] = {"R", "G", "B"};
constexpr const char* kVersionName = "krokMorphVersion";
constexpr const char* kNamesName = "krokMorphTargets";
constexpr const char* kVerticesName = "krokMorphVertices";
constexpr const char* kNormalsName = "krokMorphNormals";
constexpr const char* kProvenanceName = "krokProvenance";

class BytesOut : public Imf::OStream {
 public:
  BytesOut() : OStream("texture") {}

  void write(const char in[], int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, in, static_cast<std::size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = static_cast<std::size_t>(position); }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
  std::size_t position_ = 0;
};

// Maps the image's rows from `first_row` on to `texels`.
Imf::FrameBuffer rows_in(std::vector<Vec3f>& texels, std::size_t width, std::size_t first_row) {
  static_assert(sizeof(Vec3f) == 12);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < 3; ++c) {
    char* base = reinterpret_cast<char*>(texels.data()) + 4 * c;
    buffer.insert(kChannels[c], Imf::Slice(Imf::FLOAT, base - first_row * width * sizeof(Vec3f),
                                           sizeof(Vec3f), width * sizeof(Vec3f)));
  }
  return buffer;
}

Error not_morphs(std::string message) {
  return Error(
      "exr-morphs", std::move(message),
      "krok-import --save-morphs writes such files; formats/morph_exr/SPEC.md describes them");
}

int int_attribute(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::IntAttribute>(name);
  return attribute == nullptr ? -1 : attribute->value();
}

struct Layout {
  std::size_t width = 0, rows = 0;  // of a half
};

// The width is the power of two that makes the image nearly square.
Layout layout_of(std::uint64_t vertices) {
  std::uint64_t width = 1;
  while (width < kMaxWidth && width * width < 2 * vertices) width *= 2;
  return {static_cast<std::size_t>(width),
          static_cast<std::size_t>((vertices + width - 1) / width)};
}

Status check_channels(const Imf::Header& header) {
  std::size_t count = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const bool known = std::any_of(std::begin(kChannels), std::end(kChannels), [&](const char* c) {
      return std::strcmp(c, channel.name()) == 0;
    });
    if (!known || channel.channel().type != Imf::FLOAT || channel.channel().xSampling != 1 ||
        channel.channel().ySampling != 1) {
      return not_morphs("the channels must be R, G and B of 32-bit floats");
    }
    ++count;
  }
  if (count != 3) return not_morphs("the channels must be R, G and B of 32-bit floats");
  return {};
}

Result<MorphSet> read_checked(std::span<const std::byte> file, const HeaderFacts& facts) {
  BytesIn stream(file);
  Imf::InputFile input(stream, 1);
  const Imf::Header& header = input.header();
  const auto* names = header.findTypedAttribute<Imf::StringVectorAttribute>(kNamesName);
  const int version = int_attribute(header, kVersionName);
  if (version < 1 || names == nullptr) return not_morphs("the image has no morph targets");
  if (version > kMorphVersion) {
    return not_morphs(fmt::format("the file has version {}; this program reads up to version {}",
                                  version, kMorphVersion));
  }
  if (Status status = check_channels(header); !status) return status.error();
  MorphSet morphs;
  morphs.names = names->value();
  morphs.vertex_count = int_attribute(header, kVerticesName);
  const int with_normals = int_attribute(header, kNormalsName);
  const std::uint64_t width = facts.width, rows = facts.height / 2;
  const auto vertices = static_cast<std::uint64_t>(std::max(0, morphs.vertex_count));
  const std::uint64_t texels = vertices * morphs.names.size();
  if (texels == 0 || facts.height % 2 != 0 || rows != (texels + width - 1) / width ||
      with_normals < 0 || with_normals > 1) {
    return not_morphs(fmt::format("{} targets of {} vertices do not match {} by {} texels",
                                  morphs.names.size(), morphs.vertex_count, facts.width,
                                  facts.height));
  }
  const auto* origin = header.findTypedAttribute<Imf::StringAttribute>(kProvenanceName);
  if (origin != nullptr) {
    auto provenance = provenance_from_text(origin->value());
    if (!provenance) return provenance.error();
    morphs.provenance = std::move(*provenance);
  }
  const auto half = static_cast<std::size_t>(width * rows);
  const int last = static_cast<int>(rows) - 1;
  morphs.positions.resize(half);
  input.setFrameBuffer(rows_in(morphs.positions, facts.width, 0));
  input.readPixels(0, last);
  morphs.positions.resize(static_cast<std::size_t>(texels));
  if (with_normals == 1) {
    morphs.normals.resize(half);
    input.setFrameBuffer(rows_in(morphs.normals, facts.width, rows));
    input.readPixels(last + 1, 2 * last + 1);
    morphs.normals.resize(static_cast<std::size_t>(texels));
  }
  if (Status status = check(morphs); !status) return status.error();
  return morphs;
}

// Writes one half of the image: the texels in order, padded with zeros.
void write_half(Imf::OutputFile& output, const std::vector<Vec3f>& values, const Layout& layout,
                std::size_t first_row) {
  std::vector<Vec3f> texels = values;
  texels.resize(layout.width * layout.rows, Vec3f::Zero());
  output.setFrameBuffer(rows_in(texels, layout.width, first_row));
  output.writePixels(static_cast<int>(layout.rows));
}

}  // namespace

Result<ImageSize> image_size(std::span<const std::byte> file) {
  const auto facts = scan_header(file);
  if (!facts) return facts.error();
  return ImageSize{static_cast<int>(facts->width), static_cast<int>(facts->height)};
}

Result<MorphSet> read(std::span<const std::byte> file) {
  const auto facts = scan_header(file);
  if (!facts) return facts.error();
  try {
    return read_checked(file, *facts);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return Error("exr-data", fmt::format("cannot read the image: {}", error.what()),
                 "the file is damaged or truncated");
  }
}

Status write(const MorphSet& morphs, OutputFile& file) {
  if (Status status = check(morphs); !status) return status;
  const std::uint64_t texels = morphs.positions.size();
  if (texels == 0) return Error("exr-morphs", "there are no morph targets to write");
  const Layout layout = layout_of(texels);
  if (layout.rows > kMaxRows) {
    return Error("exr-morphs", fmt::format("{} targets of {} vertices are too many for a texture",
                                           morphs.target_count(), morphs.vertex_count));
  }
  const auto provenance = provenance_to_text(morphs.provenance);
  if (!provenance) return provenance.error();
  BytesOut stream;
  try {
    Imf::Header header(static_cast<int>(layout.width), static_cast<int>(2 * layout.rows));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* channel : kChannels)
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    header.insert(kVersionName, Imf::IntAttribute(kMorphVersion));
    header.insert(kNamesName, Imf::StringVectorAttribute(morphs.names));
    header.insert(kVerticesName, Imf::IntAttribute(morphs.vertex_count));
    header.insert(kNormalsName, Imf::IntAttribute(morphs.normals.empty() ? 0 : 1));
    header.insert(kProvenanceName, Imf::StringAttribute(*provenance));
    Imf::OutputFile output(stream, header, 1);
    write_half(output, morphs.positions, layout, 0);
    write_half(output, morphs.normals, layout, layout.rows);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return Error("exr-data", fmt::format("cannot write the texture: {}", error.what()));
  }
  return file.write(stream.bytes());
}

// Source: OpenEXR File Layout, https://openexr.com/en/latest/OpenEXRFileLayout.html

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
