#include "formats/bvh/motion_rows.h"

#include <fast_float/fast_float.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/text.h"

namespace krok::bvh {

namespace {

constexpr int kFarthest = 64;
constexpr int kMostDigits = 15;
constexpr std::array<double, kMostDigits + 1> kPowersOfTen = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

// Reads a number as nearly all are printed, [-]digits[.digits] with up to 15 of them, before white
// space; false for any other, which may be a number still. White space must stand somewhere after
// `at`, so that no digit is looked for beyond the text. All digits as one integer and the power of
// ten are exact in a double, so that their quotient is the number rounded once, as it should be
// (W. Clinger, "How to read floating point numbers accurately", 1990).
inline bool parse_plain_number(const char*& at, double& value) {
  const char* p = at;
  const bool negative = *p == '-';
  if (negative) ++p;
  std::uint64_t integer = 0;  // wraps where there are too many digits, which are counted
  const auto take_digits = [&] {
    const char* first = p;
    for (;; ++p) {
      const auto digit = static_cast<unsigned>(static_cast<unsigned char>(*p)) - '0';
      if (digit > 9) return p - first;
      integer = 10 * integer + digit;
    }
  };
  const std::ptrdiff_t before = take_digits();
  std::ptrdiff_t after = 0;
  if (*p == '.') {
    ++p;
    after = take_digits();
    if (after == 0) return false;
  }
  if (before == 0 || before + after > kMostDigits || !is_space(*p)) return false;
  const double size = static_cast<double>(integer) / kPowersOfTen[static_cast<std::size_t>(after)];
  value = negative ? -size : size;
  at = p;
  return true;
}

// Reads one number and steps over it; false if it is not whole, or beyond what a float holds.
inline bool parse_number(const char*& at, const char* end, double& value) {
  const char* begin = at;
  if (begin != end && *begin == '+' && end - begin > 1 && begin[1] != '-' && begin[1] != '+') {
    ++begin;
  }
  const auto parsed = fast_float::from_chars(begin, end, value);
  if (parsed.ec != std::errc() || !(std::abs(value) <= std::numeric_limits<float>::max())) {
    return false;
  }
  if (parsed.ptr != end && !is_space(*parsed.ptr)) return false;
  at = parsed.ptr;
  return true;
}

}  // namespace

std::size_t parse_row(std::string_view text, std::size_t begin, std::span<double> values) {
  const char* at = text.data() + begin;
  const char* const end = text.data() + text.size();
  // White space near the end of the text; what begins before it ends before it.
  const char* last_space = at == end ? at : end - 1;
  for (int i = 0; i < kFarthest && last_space > at && !is_space(*last_space); ++i) --last_space;
  if (last_space != at && !is_space(*last_space)) last_space = at;
  for (double& value : values) {
    while (at != end && is_space(*at)) ++at;
    if (at < last_space && parse_plain_number(at, value)) continue;
    if (at == end || !parse_number(at, end, value)) return RowIndex::kFaulty;
  }
  return static_cast<std::size_t>(at - text.data());
}

std::vector<std::size_t> index_lines(std::string_view text, std::size_t begin) {
  std::vector<std::size_t> begins;
  for (std::size_t line = begin; line < text.size();) {
    const void* found = std::memchr(text.data() + line, '\n', text.size() - line);
    const std::size_t end =
        found == nullptr ? text.size()
                         : static_cast<std::size_t>(static_cast<const char*>(found) - text.data());
    std::size_t first = line;
    while (first < end && is_space(text[first])) ++first;
    if (first < end) begins.push_back(first);
    line = end + 1;
  }
  return begins;
}

}  // namespace krok::bvh
