#include "formats/gltf/filters_internal.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/text.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/reader_internal.h"

namespace krok::gltf {

namespace {

constexpr double kLargestMantissa = (1 << 23) - 1;

}  // namespace

std::vector<std::int8_t> octahedral(std::span<const Vec4f> vectors) {
  std::vector<std::int8_t> numbers(4 * vectors.size());
  std::vector<Vec4f> signs(vectors.begin(), vectors.end());
  for (Vec4f& vector : signs) vector.w() = vector.w() < 0 ? -1.0f : 1.0f;
  meshopt_encodeFilterOct(numbers.data(), signs.size(), 4, 8, signs.data()->data());
  return numbers;
}

void decode_octahedral(std::vector<std::int8_t>& numbers) {
  meshopt_decodeFilterOct(numbers.data(), numbers.size() / 4, 4);
}

std::vector<std::int16_t> quaternion(std::span<const Quatf> rotations, int bits) {
  std::vector<std::int16_t> numbers(4 * rotations.size());
  std::vector<Quatf> unit(rotations.begin(), rotations.end());
  for (Quatf& rotation : unit) rotation.normalize();
  meshopt_encodeFilterQuat(numbers.data(), unit.size(), 8, bits, unit.data()->coeffs().data());
  return numbers;
}

std::vector<Quatf> decoded_quaternion(std::span<const Quatf> rotations, int bits) {
  std::vector<std::int16_t> numbers = quaternion(rotations, bits);
  meshopt_decodeFilterQuat(numbers.data(), rotations.size(), 8);
  std::vector<Quatf> decoded;
  for (std::size_t i = 0; i < numbers.size(); i += 4) {
    Quatf& rotation = decoded.emplace_back();
    for (int c = 0; c < 4; ++c) {
      rotation.coeffs()[c] = static_cast<float>(numbers[i + static_cast<std::size_t>(c)]) / 32767;
    }
    rotation.normalize();
  }
  return decoded;
}

std::optional<std::vector<std::uint32_t>> exponential(std::span<const float> values, int exponent) {
  std::vector<std::uint32_t> numbers;
  for (const float value : values) {
    const double steps = std::round(std::ldexp(static_cast<double>(value), -exponent));
    if (!(std::abs(steps) <= kLargestMantissa)) return std::nullopt;
    const auto mantissa = static_cast<std::uint32_t>(static_cast<std::int32_t>(steps));
    numbers.push_back(static_cast<std::uint32_t>(exponent) << 24 | (mantissa & 0xFFFFFFu));
  }
  return numbers;
}

float in_steps(float value, int exponent) {
  return static_cast<float>(
      std::ldexp(std::round(std::ldexp(static_cast<double>(value), -exponent)), exponent));
}

namespace {

Error bad_view(const PackedView& packed, const std::string& what) {
  return Error("gltf-compression",
               fmt::format("buffer view {} (meshopt compression): {}", packed.view, what),
               kDamagedHint);
}

// What the extension's page requires of each mode and filter; the library asserts some of it.
Status check_parameters(const PackedView& packed) {
  const std::uint64_t stride = packed.stride;
  const bool attributes = packed.mode == "ATTRIBUTES";
  if (attributes && (stride == 0 || stride > 256 || stride % 4 != 0)) {
    return bad_view(
        packed, fmt::format("a stride of {} bytes; multiples of 4 up to 256 are valid", stride));
  }
  if (!attributes && packed.mode != "TRIANGLES" && packed.mode != "INDICES") {
    return bad_view(packed, fmt::format("mode '{}' is not known", shown(packed.mode)));
  }
  if (!attributes && stride != 2 && stride != 4) {
    return bad_view(packed, fmt::format("indices of {} bytes; 2 and 4 are valid", stride));
  }
  if (packed.mode == "TRIANGLES" && packed.count % 3 != 0) {
    return bad_view(packed, fmt::format("{} indices do not form whole triangles", packed.count));
  }
  const bool fits = packed.filter == "NONE" || packed.filter.empty() ||
                    ((packed.filter == "OCTAHEDRAL" || packed.filter == "COLOR") &&
                     (stride == 4 || stride == 8)) ||
                    (packed.filter == "QUATERNION" && stride == 8) ||
                    (packed.filter == "EXPONENTIAL" && stride % 4 == 0);
  const bool filtered = !packed.filter.empty() && packed.filter != "NONE";
  if (!fits || (filtered && !attributes)) {
    return bad_view(packed, fmt::format("filter '{}' does not fit elements of {} bytes",
                                        shown(packed.filter), stride));
  }
  return {};
}

Result<std::span<const std::byte>> packed_bytes(const PackedView& packed, const Buffers& buffers) {
  if (packed.buffer >= buffers.views.size()) {
    return bad_view(packed, fmt::format("buffer {} does not exist", packed.buffer));
  }
  const auto buffer = buffers.views[packed.buffer];
  if (packed.offset > buffer.size() || packed.length > buffer.size() - packed.offset) {
    return bad_view(packed, fmt::format("exceeds its buffer of {} bytes", buffer.size()));
  }
  return buffer.subspan(packed.offset, packed.length);
}

bool unpack(const PackedView& packed, std::span<const std::byte> bytes, unsigned char* to) {
  const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
  const std::size_t count = packed.count, stride = packed.stride;
  if (packed.mode == "TRIANGLES") {
    return meshopt_decodeIndexBuffer(to, count, stride, from, bytes.size()) == 0;
  }
  if (packed.mode == "INDICES") {
    return meshopt_decodeIndexSequence(to, count, stride, from, bytes.size()) == 0;
  }
  if (is_second_codec(bytes)) {
    if (!unpack_second_codec(bytes, stride, {reinterpret_cast<std::byte*>(to), count * stride})) {
      return false;
    }
  } else if (meshopt_decodeVertexBuffer(to, count, stride, from, bytes.size()) != 0) {
    return false;
  }
  if (packed.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(to, count, stride);
  if (packed.filter == "QUATERNION") meshopt_decodeFilterQuat(to, count, stride);
  if (packed.filter == "EXPONENTIAL") meshopt_decodeFilterExp(to, count, stride);
  if (packed.filter == "COLOR") {
    unfilter_colours({reinterpret_cast<std::byte*>(to), count * stride}, stride);
  }
  return true;
}

}  // namespace

Status unpack_meshopt(ParsedJson& parsed, Buffers& buffers, std::uint64_t most_bytes) {
  for (const PackedView& packed : parsed.packed_views) {
    if (packed.view >= parsed.model.bufferViews.size()) return bad_view(packed, "cannot be read");
    if (Status status = check_parameters(packed); !status) return status;
    const auto bytes = packed_bytes(packed, buffers);
    if (!bytes) return bytes.error();
    if (packed.count > most_bytes / packed.stride) {
      return Error("gltf-too-large",
                   fmt::format("buffer view {} unpacks to far more data than the file contains",
                               packed.view));
    }
    const std::uint64_t size = packed.count * packed.stride;
    most_bytes -= size;
    auto& unpacked = buffers.decoded.emplace_back(size);
    if (size > 0 && !unpack(packed, *bytes, unpacked.data())) {
      return bad_view(packed, "its data is invalid");
    }
    tinygltf::BufferView& view = parsed.model.bufferViews[packed.view];
    view.buffer = static_cast<int>(buffers.views.size());
    view.byteOffset = 0;
    view.byteLength = size;
    buffers.views.push_back(std::as_bytes(std::span(unpacked)));
  }
  return {};
}

namespace {

constexpr std::uint8_t kHeader = 0xA1;
constexpr std::size_t kGroup = 16;           // values that share a number of bits
constexpr std::size_t kBlockBytes = 8192;    // of elements that are packed together
constexpr std::size_t kBlockElements = 256;  // most of them
constexpr std::size_t kShortestTail = 24;
constexpr std::size_t kLongestElement = 256;

// What a control of two bits says of a byte of all elements of a block.
enum Control : unsigned { kFewBits, kMoreBits, kZeros, kPlain };

class SecondCodec {
 public:
  SecondCodec(std::span<const std::byte> packed, std::size_t stride)
      : data_(packed), stride_(stride) {}

  bool unpack(std::span<std::byte> to) {
    const std::size_t tail = stride_ + stride_ / 4;
    const std::size_t padded = std::max(tail, kShortestTail);
    if (data_.size() < 1 + padded) return false;
    const auto end = data_.last(tail);
    for (std::size_t i = 0; i < stride_; ++i) last_[i] = byte(end[i]);
    channels_ = end.subspan(stride_);
    data_ = data_.subspan(1, data_.size() - 1 - padded);
    const std::size_t count = to.size() / stride_;
    const std::size_t block = std::min(kBlockBytes / stride_ / kGroup * kGroup, kBlockElements);
    for (std::size_t first = 0; first < count; first += block) {
      const std::size_t size = std::min(block, count - first);
      if (!unpack_block(to.subspan(first * stride_, size * stride_), size)) return false;
    }
    return data_.empty();
  }

 private:
  static std::uint8_t byte(std::byte value) { return std::to_integer<std::uint8_t>(value); }

  // The next bytes; none if there are fewer.
  std::span<const std::byte> take(std::size_t count) {
    if (count > data_.size()) {
      short_ = true;
      return {};
    }
    const auto taken = data_.first(count);
    data_ = data_.subspan(count);
    return taken;
  }

  bool unpack_block(std::span<std::byte> to, std::size_t count) {
    const auto controls = take(stride_ / 4);
    for (std::size_t k = 0; k < stride_ && !short_; k += 4) {
      for (std::size_t j = 0; j < 4 && !short_; ++j) {
        unpack_bytes(byte(controls[k / 4]) >> (2 * j) & 3u, count, planes_[j]);
      }
      const unsigned channel = byte(channels_[k / 4]);
      if (short_ || (channel & 3u) == 3) return false;
      for (std::size_t i = 0; i < count; ++i) {
        add_difference(channel, i, last_.data() + k);
        for (std::size_t j = 0; j < 4; ++j) to[i * stride_ + k + j] = std::byte{last_[k + j]};
      }
    }
    return !short_;
  }

  // One byte of each element.
  void unpack_bytes(unsigned control, std::size_t count,
                    std::array<std::uint8_t, kBlockElements>& to) {
    if (control == kZeros) {
      to.fill(0);
    } else if (control == kPlain) {
      std::ranges::transform(take(count), to.begin(), byte);
    } else {
      const std::size_t groups = (count + kGroup - 1) / kGroup;
      const auto header = take((groups + 3) / 4);
      for (std::size_t g = 0; g < groups && !short_; ++g) {
        const unsigned bits = byte(header[g / 4]) >> (2 * (g % 4)) & 3u;
        constexpr std::array<unsigned, 5> kBits = {0, 1, 2, 4, 8};
        unpack_group(kBits[bits + control], std::span(to).subspan(g * kGroup, kGroup));
      }
    }
  }

  // A value of all ones is an escape: the byte follows the group. Single bits come lowest first,
  // others highest first.
  void unpack_group(unsigned bits, std::span<std::uint8_t> to) {
    const auto packed = take(bits * kGroup / 8);
    for (std::size_t i = 0; i < kGroup && !short_; ++i) {
      if (bits == 0 || bits == 8) {
        to[i] = bits == 0 ? std::uint8_t{0} : byte(packed[i]);
        continue;
      }
      const std::size_t place = i * bits % 8;
      const unsigned shift = static_cast<unsigned>(bits == 1 ? place : 8 - bits - place);
      const unsigned mask = (1u << bits) - 1;
      const unsigned value = byte(packed[i * bits / 8]) >> shift & mask;
      to[i] = static_cast<std::uint8_t>(value);
      if (value != mask) continue;
      const auto escaped = take(1);
      if (!short_) to[i] = byte(escaped[0]);
    }
  }

  // Applies the difference of element i to four bytes of the one before: as bytes, as two numbers
  // of 16 bits (both zigzag), or as one of 32, rotated, by exclusive or.
  void add_difference(unsigned channel, std::size_t i, std::uint8_t* last) {
    const auto joined = [&](std::size_t first, std::size_t count, const auto& byte_at) {
      std::uint32_t value = 0;
      for (std::size_t j = 0; j < count; ++j) value |= std::uint32_t{byte_at(first + j)} << (8 * j);
      return value;
    };
    const std::size_t size = std::size_t{1} << (channel & 3u);
    for (std::size_t first = 0; first < 4; first += size) {
      const std::uint32_t difference =
          joined(first, size, [&](std::size_t j) { return planes_[j][i]; });
      const std::uint32_t before = joined(first, size, [&](std::size_t j) { return last[j]; });
      const std::uint32_t value =
          size == 4 ? std::rotr(difference, static_cast<int>(channel >> 4)) ^ before
                    : (difference >> 1 ^ (0u - (difference & 1u))) + before;
      for (std::size_t j = 0; j < size; ++j) {
        last[first + j] = static_cast<std::uint8_t>(value >> (8 * j));
      }
    }
  }

  std::span<const std::byte> data_, channels_;
  const std::size_t stride_;
  std::array<std::uint8_t, kLongestElement> last_{};  // the element before
  std::array<std::array<std::uint8_t, kBlockElements>, 4> planes_{};
  bool short_ = false;
};

// YCoCg of reversible integers with the bits of alpha's range; see the appendix.
template <typename Unsigned>
void unfilter(std::span<std::byte> bytes) {
  constexpr float kMax = static_cast<float>(static_cast<Unsigned>(~Unsigned{0}));
  // Two's complement.
  constexpr int kRange = 1 << (8 * sizeof(Unsigned));
  const auto with_sign = [](int value) { return value < kRange / 2 ? value : value - kRange; };
  auto* const values = reinterpret_cast<Unsigned*>(bytes.data());
  for (std::size_t i = 0; i + 3 < bytes.size() / sizeof(Unsigned); i += 4) {
    Unsigned* const c = values + i;
    const int range = static_cast<int>(std::bit_ceil(static_cast<unsigned>(c[3]) + 1)) - 1;
    const int y = c[0], co = with_sign(c[1]), cg = with_sign(c[2]);
    const int alpha = ((c[3] << 1) & range) | (c[3] & 1);
    const std::array<int, 4> colour = {y + co - cg, y + cg, y - co - cg, alpha};
    for (std::size_t k = 0; k < 4; ++k) {
      const float scaled =
          range > 0 ? static_cast<float>(colour[k]) * (kMax / static_cast<float>(range)) : 0;
      c[k] = static_cast<Unsigned>(std::clamp(scaled + 0.5f, 0.0f, kMax));
    }
  }
}

}  // namespace

bool is_second_codec(std::span<const std::byte> packed) {
  return !packed.empty() && packed[0] == std::byte{kHeader};
}

bool unpack_second_codec(std::span<const std::byte> packed, std::size_t stride,
                         std::span<std::byte> to) {
  return SecondCodec(packed, stride).unpack(to);
}

void unfilter_colours(std::span<std::byte> colours, std::size_t stride) {
  if (stride == 4) {
    unfilter<std::uint8_t>(colours);
  } else {
    unfilter<std::uint16_t>(colours);
  }
}

}  // namespace krok::gltf
