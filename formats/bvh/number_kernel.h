#pragma once

#include <cstddef>
#include <cstdint>

// SIMD parser for rows of plain decimal numbers, which nearly all captures use.

namespace krok::bvh::number_kernel {

// Number of bytes read before and after a row; they must be readable.
inline constexpr std::size_t kBefore = 16;
inline constexpr std::size_t kAfter = 64;

// Required size of `edges` for `count` numbers.
constexpr std::size_t edges_for(std::size_t count) {
  return 2 * count + 256;
}

// Parses the row from `row` to before `end`, with white space before both, if it has exactly
// `count` words, each [-][digits][.digits] of up to 16 characters with up to 15 digits after
// leading zeros. Stores the values `stride` elements apart, each the nearest double, bit-identical
// to fast_float. Returns false otherwise, though the row may still be valid (use parse_row()), and
// on machines without 32-byte vectors.
bool parse_plain_row(const char* row, const char* end, std::size_t count, double* values,
                     std::size_t stride, std::uint32_t* edges);

}  // namespace krok::bvh::number_kernel
