#include "formats/height_field/height_image.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <new>
#include <string>

#include "core/text.h"
#include "formats/image/decode_image.h"
#include "formats/json/fields.h"
#include "formats/morph_exr/exr_input_internal.h"

namespace krok::height_field {

namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
constexpr std::string_view kExrMagic = "\x76\x2F\x31\x01";
constexpr std::string_view kPngMagic = "\x89PNG";
constexpr std::string_view kJpegMagic = "\xFF\xD8\xFF";

// The channel that has the heights; empty if the image has none.
std::string channel_of(const Imf::ChannelList& channels) {
  for (const char* name : {"height", "Height", "Y", "Z", "R"}) {
    if (channels.findChannel(name) != nullptr) return name;
  }
  return channels.begin() == channels.end() ? std::string() : channels.begin().name();
}

Result<HeightImage> read_checked_exr(std::span<const std::byte> file,
                                     const morph_exr::HeaderFacts& facts) {
  morph_exr::BytesIn stream(file);
  Imf::InputFile input(stream, 1);
  const Imf::ChannelList& channels = input.header().channels();
  const std::string name = channel_of(channels);
  const Imf::Channel* channel = channels.findChannel(name.c_str());
  if (channel == nullptr) return Error("exr-data", "the image has no channel");
  if (channel->xSampling != 1 || channel->ySampling != 1) {
    return Error("exr-data", fmt::format("the channel '{}' is subsampled", shown(name)),
                 "save it at full resolution");
  }
  HeightImage image{static_cast<int>(facts.width), static_cast<int>(facts.height), {}};
  image.values.resize(std::size_t{facts.width} * facts.height);
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(image.values.data()),
                                 sizeof(float), sizeof(float) * facts.width));
  input.setFrameBuffer(buffer);
  input.readPixels(0, static_cast<int>(facts.height) - 1);
  return image;
}

Status check_count(std::uint64_t columns, std::uint64_t rows) {
  if (columns * rows <= static_cast<std::uint64_t>(terrain::kMaxHeights)) return {};
  return Error("height-size",
               fmt::format("the image has {} x {} samples, the limit is {} in total", columns, rows,
                           terrain::kMaxHeights),
               "reduce its size");
}

Result<HeightImage> read_exr(std::span<const std::byte> file) {
  const auto facts = morph_exr::scan_header(file, 2);
  if (!facts) return facts.error();
  if (Status status = check_count(facts->width, facts->height); !status) return status.error();
  try {
    return read_checked_exr(file, *facts);
  } catch (const std::bad_alloc&) {
    return Error("exr-data", "not enough memory for the image");
  } catch (const std::exception& fault) {
    return Error("exr-data", fmt::format("cannot read the image: {}", shown(fault.what())),
                 "the file is damaged or truncated");
  }
}

Result<HeightImage> read_png(std::span<const std::byte> file) {
  const auto pixels = image::decode_grey(file, static_cast<std::size_t>(terrain::kMaxHeights));
  if (!pixels) return pixels.error();
  constexpr std::size_t kBitDepth = 24;  // its byte in a PNG file
  const int levels = 1 << std::to_integer<int>(file[kBitDepth]);
  HeightImage image{pixels->width, pixels->height, {}, true, levels};
  image.values.resize(pixels->values.size());
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const bool hole = !pixels->opacity.empty() && pixels->opacity[i] < 0x8000;
    image.values[i] = hole ? kHole : static_cast<float>(pixels->values[i] / 65535.0);
  }
  return image;
}

}  // namespace

Result<HeightImage> read(std::span<const std::byte> file) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  if (text.starts_with(kExrMagic)) return read_exr(file);
  if (text.starts_with(kPngMagic) || text.starts_with(kJpegMagic)) return read_png(file);
  return Error("height-kind", "is no OpenEXR or PNG image");
}

Result<terrain::HeightField> placed(HeightImage image, const Placement& placement) {
  if (!placement.size) {
    return Error("height-placement", "the image does not say how large the ground is",
                 "give --ground-size WIDTHxDEPTH, or a sidecar NAME.ground.json with \"size\"");
  }
  if (image.shares && !placement.range) {
    return Error("height-placement", "a PNG does not say how high black and white are",
                 "give --ground-range LOW,HIGH, or a sidecar NAME.ground.json with \"range\"");
  }
  terrain::HeightField field;
  field.columns = image.columns;
  field.rows = image.rows;
  field.width = (*placement.size)[0];
  field.depth = (*placement.size)[1];
  if (placement.centre) {
    field.centre_x = (*placement.centre)[0];
    field.centre_z = (*placement.centre)[1];
  }
  field.heights = std::move(image.values);
  if (placement.range) {
    const auto [low, high] = *placement.range;
    for (float& height : field.heights) {
      height = static_cast<float>(low + (high - low) * static_cast<double>(height));
    }
  }
  return field;
}

namespace {

using json::Given;
using JsonKind = json::Value::Kind;
using Lengths = std::array<double, 2>;

// Two lengths: numbers in metres, or strings with a unit.
Status read_lengths(const Given& given, Lengths& to) {
  if (Status status = given.is(JsonKind::array); !status) return status;
  const auto& items = given.value.items;
  if (items.size() != 2) {
    return given.wrong(fmt::format("\"{}\" has {} values, expected 2", given.key, items.size()));
  }
  const std::string what = fmt::format("\"{}\"", given.key);
  for (std::size_t i = 0; i < 2; ++i) {
    const Given item{given.source, items[i], {}, what};
    if (items[i].kind == JsonKind::number) {
      if (Status status = json::number(-1e6, 1e6).read(item, &to[i]); !status) return status;
      continue;
    }
    const auto length = parse_length(items[i].kind == JsonKind::string ? items[i].text : "");
    if (!length) {
      return item.wrong(fmt::format("{} has a value that is no length", what),
                        "write metres, or a string such as \"20cm\"");
    }
    to[i] = *length;
  }
  return {};
}

json::Object<Placement> table() {
  const auto lengths = json::kind<Lengths>(
      json::schema_of_list(json::quantity(parse_length, "metres").schema(), 2, 2), read_lengths);
  json::Object<Placement> file;
  file.file("krok.ground/1", "Place and size of a height image (krok.ground/1)").comment();
  file.field("size", &Placement::size, lengths, "along x and z");
  file.field("range", &Placement::range, lengths, "height of black and white");
  file.field("centre", &Placement::centre, lengths, "x and z");
  return file;
}

}  // namespace

Result<Placement> read_sidecar(std::string_view text) {
  return table().read_text(text, "ground", std::size_t{64} << 10);
}

std::string schema() {
  return table().schema();
}

}  // namespace krok::height_field
