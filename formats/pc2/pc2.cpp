#include "formats/pc2/pc2.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "math/vector_arrays.h"

namespace krok::pc2 {

namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

constexpr std::array<char, 12> kMagic = {'P', 'O', 'I', 'N', 'T', 'C',
                                         'A', 'C', 'H', 'E', '2', '\0'};

constexpr std::size_t kMaxCount = 0x7FFFFFFF;  // vertices or samples
constexpr std::int32_t kVersion = 1;

struct Header {
  std::array<char, 12> magic = kMagic;
  std::int32_t version = kVersion;
  std::int32_t points = 0;
  float start_frame = 0;
  float frames_per_sample = 1;
  std::int32_t samples = 0;
};

static_assert(sizeof(Header) == 32);
constexpr std::uint64_t kVectorBytes = 3 * sizeof(float);

Status check(const Header& header) {
  if (header.version != kVersion) {
    return Error("pc2-version",
                 fmt::format("the file has version {}, expected {}", header.version, kVersion))
        .at_byte(offsetof(Header, version));
  }
  if (header.points < 0) {
    return Error("pc2-value", fmt::format("invalid number of vertices, {}", header.points))
        .at_byte(offsetof(Header, points));
  }
  if (header.samples < 0) {
    return Error("pc2-value", fmt::format("invalid number of samples, {}", header.samples))
        .at_byte(offsetof(Header, samples));
  }
  if (!std::isfinite(header.start_frame)) {
    return Error("pc2-value", "the start frame is not finite")
        .at_byte(offsetof(Header, start_frame));
  }
  if (!std::isfinite(header.frames_per_sample) || header.frames_per_sample <= 0) {
    return Error("pc2-value",
                 fmt::format("invalid number of frames per sample, {}", header.frames_per_sample))
        .at_byte(offsetof(Header, frames_per_sample));
  }
  return {};
}

Status check_option(const char* what, double value) {
  if (std::isfinite(value) && std::abs(value) <= std::numeric_limits<float>::max()) return {};
  return Error("pc2-option", fmt::format("a point cache cannot store the {} {}", what, value));
}

Status check(const WriteOptions& options) {
  if (Status status = check_option("start frame", options.start_frame); !status) return status;
  if (Status status = check_option("scale", options.scale); !status) return status;
  if (Status status = check_option("sampling", options.frames_per_sample); !status) return status;
  if (!(options.scale > 0)) return Error("pc2-option", "the scale must be greater than 0");
  if (static_cast<float>(options.frames_per_sample) > 0) return {};
  return Error("pc2-option", "the frames per sample must be greater than 0");
}

// Converts a shape to the file's axes and units.
Status convert(const WriteOptions& options, int frame, std::span<Vec3f> positions) {
  const auto scale = static_cast<float>(options.scale);
  if (options.up == Up::z) {
    for (Vec3f& position : positions) position = Vec3f(position.x(), -position.z(), position.y());
  }
  if (scale != 1.0f) {
    for (Vec3f& position : positions) position *= scale;
  }
  if (all_finite(positions)) return {};
  return Error("pc2-value", fmt::format("a vertex of frame {} is not finite", frame));
}

}  // namespace

Result<PointCache> PointCache::read(std::span<const std::byte> file) {
  Header header;
  if (file.size() < sizeof kMagic || std::memcmp(file.data(), kMagic.data(), sizeof kMagic) != 0) {
    return Error("pc2-format", "the file does not begin with POINTCACHE2");
  }
  if (file.size() < sizeof header) {
    return Error("pc2-truncated", fmt::format("truncated header of {} bytes", file.size()));
  }
  std::memcpy(&header, file.data(), sizeof header);
  if (Status status = check(header); !status) return status.error();

  // Divide: the product of up to 12 * 2^62 would overflow 64 bits.
  const std::uint64_t left = file.size() - sizeof header;
  const auto points = static_cast<std::uint64_t>(header.points);
  const auto samples = static_cast<std::uint64_t>(header.samples);
  if (points > 0 && left / (points * kVectorBytes) < samples) {
    return Error("pc2-truncated",
                 fmt::format("{} samples of {} vertices exceed the file's {} bytes", samples,
                             points, file.size()),
                 "the file is damaged or truncated");
  }
  PointCache cache;
  const std::uint64_t bytes = samples * points * kVectorBytes;
  cache.data_ = file.subspan(sizeof header, bytes);
  cache.points_ = header.points;
  cache.samples_ = header.samples;
  cache.start_frame_ = header.start_frame;
  cache.frames_per_sample_ = header.frames_per_sample;
  cache.bytes_left_ = left - bytes;
  return cache;
}

Status PointCache::get(std::int64_t sample, std::span<Vec3f> positions) const {
  assert(sample >= 0 && sample < samples_);
  assert(positions.size() == static_cast<std::size_t>(points_));
  const std::size_t begin = static_cast<std::size_t>(sample) * positions.size_bytes();
  // The data may not be aligned for floats.
  if (!positions.empty()) {
    std::memcpy(positions.front().data(), &data_[begin], positions.size_bytes());
  }
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (positions[v].allFinite()) continue;
    return Error("pc2-value", fmt::format("vertex {} of sample {} is not finite", v, sample))
        .at_byte(static_cast<std::int64_t>(sizeof(Header) + begin + v * kVectorBytes));
  }
  return {};
}

Status write(const Model& model, const MeshMotion& motion, const WriteOptions& options,
             OutputFile& file, Progress* progress, int jobs) {
  if (Status status = check(options); !status) return status;
  const std::size_t points = model.positions.size();
  if (points > kMaxCount) {
    return Error("pc2-too-large", fmt::format("{} vertices exceed the limit of PC2 files", points));
  }
  Header header;
  header.points = static_cast<std::int32_t>(points);
  header.start_frame = static_cast<float>(options.start_frame);
  header.frames_per_sample = static_cast<float>(options.frames_per_sample);
  header.samples = std::max(motion.frames, 0);
  if (Status status = file.write(std::as_bytes(std::span(&header, 1))); !status) return status;
  if (progress != nullptr) {
    progress->begin("writing frames", static_cast<std::uint64_t>(header.samples));
  }
  std::vector<std::span<const std::byte>> bytes;
  return make_shapes(
      motion, {0, header.samples, points, false}, jobs,
      [&](int frame, ShapeRoom& shape) { return convert(options, frame, shape.positions); },
      [&](int, std::span<const ShapeRoom> shapes) {
        if (progress != nullptr) progress->advance(shapes.size());
        bytes.clear();
        for (const ShapeRoom& shape : shapes) {
          bytes.push_back(std::as_bytes(std::span(shape.positions)));
        }
        return file.write(bytes);
      });
}

}  // namespace krok::pc2
