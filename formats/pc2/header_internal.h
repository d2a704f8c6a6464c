#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

// Private to this folder: the header of a PC2 file; see SPEC.md.

namespace krok::pc2 {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

inline constexpr std::array<char, 12> kMagic = {'P', 'O', 'I', 'N', 'T', 'C',
                                                'A', 'C', 'H', 'E', '2', '\0'};
inline constexpr std::size_t kMaxCount = 0x7FFFFFFF;  // vertices or samples
inline constexpr std::int32_t kVersion = 1;

struct Header {
  std::array<char, 12> magic = kMagic;
  std::int32_t version = kVersion;
  std::int32_t points = 0;
  float start_frame = 0;
  float frames_per_sample = 1;
  std::int32_t samples = 0;
};
static_assert(sizeof(Header) == 32);

}  // namespace krok::pc2
