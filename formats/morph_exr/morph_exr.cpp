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
#include <new>

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

}  // namespace krok::morph_exr
