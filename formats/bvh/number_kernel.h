#pragma once

#include <cstddef>
#include <cstdint>

// Rows of numbers as nearly all captures have them, parsed many at a time.

namespace krok::bvh::number_kernel {

// How many bytes around a row are looked at, and must be there.
inline constexpr std::size_t kBefore = 16;
inline constexpr std::size_t kAfter = 64;

// Elements that `edges` must have for `count` numbers.
constexpr std::size_t edges_for(std::size_t count) {
  return 2 * count + 256;
}

// Parses the row that begins at `row` and ends before `end`, with white space before each of them,
// if it has exactly `count` words, and each is [-][digits][.digits] of up to 16 characters with up
// to 15 digits behind leading zeros. Stores the values `stride` places apart, each the double
// nearest to what is printed, bit by bit what fast_float gives. False where that does not hold,
// though the row may still be one: parse_row() then tells. Also where the machine has no vectors of
// 32 bytes.
bool parse_plain_row(const char* row, const char* end, std::size_t count, double* values,
                     std::size_t stride, std::uint32_t* edges);

}  // namespace krok::bvh::number_kernel
