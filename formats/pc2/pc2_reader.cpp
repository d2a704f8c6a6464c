#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <cstring>

#include "formats/pc2/header_internal.h"
#include "formats/pc2/pc2.h"

namespace krok::pc2 {

namespace {

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

}  // namespace krok::pc2
