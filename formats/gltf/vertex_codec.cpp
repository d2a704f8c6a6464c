#include <algorithm>
#include <array>
#include <bit>

#include "formats/gltf/buffers_internal.h"

namespace krok::gltf {

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
