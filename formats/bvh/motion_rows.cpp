#include "formats/bvh/motion_rows.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/parallel.h"
#include "core/text.h"

namespace krok::bvh {

namespace {

constexpr int kFarthest = 64;
constexpr int kMaxDigits = 15;
constexpr std::array<double, kMaxDigits + 1> kPowersOfTen = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

// Fast path for the common form [-]digits[.digits] with up to 15 digits, followed by white space;
// false for any other form, which may still be a valid number. There must be white space somewhere
// after `at`, as sentinel. The digits as one integer and the power of ten are both exact in a
// double, so that their quotient is correctly rounded (W. Clinger, "How to read floating point
// numbers accurately", 1990).
inline bool parse_plain_number(const char*& at, double& value) {
  const char* p = at;
  const bool negative = *p == '-';
  if (negative) ++p;
  std::uint64_t integer = 0;  // wraps if there are too many digits, which is detected by counting
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
  if (before == 0 || before + after > kMaxDigits || !is_space(*p)) return false;
  const double size = static_cast<double>(integer) / kPowersOfTen[static_cast<std::size_t>(after)];
  value = negative ? -size : size;
  at = p;
  return true;
}

// Reads one number and advances past it; false if it is incomplete or out of float range.
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

// Adds the offset of the first character that is not white space of each line that begins in
// [first, last). Lines begin at `begin` and after line ends.
void add_lines(std::string_view text, std::size_t begin, std::size_t first, std::size_t last,
               std::vector<std::size_t>& begins) {
  const auto line_end = [&](std::size_t from) {
    const void* found = std::memchr(text.data() + from, '\n', text.size() - from);
    return found == nullptr
               ? text.size()
               : static_cast<std::size_t>(static_cast<const char*>(found) - text.data());
  };
  std::size_t line = first;
  if (first > begin && text[first - 1] != '\n') line = line_end(first) + 1;
  while (line < last) {
    const std::size_t end = line_end(line);
    std::size_t at = line;
    while (at < end && is_space(text[at])) ++at;
    if (at < end) begins.push_back(at);
    line = end + 1;
  }
}

}  // namespace

std::size_t parse_row(std::string_view text, std::size_t begin, std::span<double> values) {
  return parse_row(text, begin, values.data(), values.size(), 1);
}

std::size_t parse_row(std::string_view text, std::size_t begin, double* values, std::size_t count,
                      std::size_t stride) {
  const char* at = text.data() + begin;
  const char* const end = text.data() + text.size();
  // The last white space of the text; a number that begins before it ends before it.
  const char* last_space = at == end ? at : end - 1;
  for (int i = 0; i < kFarthest && last_space > at && !is_space(*last_space); ++i) --last_space;
  if (last_space != at && !is_space(*last_space)) last_space = at;
  for (std::size_t i = 0; i < count; ++i) {
    double& value = values[i * stride];
    while (at != end && is_space(*at)) ++at;
    if (at < last_space && parse_plain_number(at, value)) continue;
    if (at == end || !parse_number(at, end, value)) return RowIndex::kFaulty;
  }
  return static_cast<std::size_t>(at - text.data());
}

std::vector<std::size_t> index_lines(std::string_view text, std::size_t begin, int jobs,
                                     const std::function<void(std::size_t offset)>& release) {
  constexpr std::size_t kStretch = std::size_t{1} << 20;
  const std::size_t size = text.size() - std::min(begin, text.size());
  std::vector<std::vector<std::size_t>> found(slots_for(jobs));
  std::vector<std::size_t> begins;
  const auto find = [&](std::size_t stretch, std::size_t slot) {
    const std::size_t first = begin + stretch * kStretch;
    add_lines(text, begin, first, std::min(first + kStretch, text.size()), found[slot]);
    return Status();
  };
  const auto take = [&](std::size_t stretch, std::size_t slot) {
    begins.insert(begins.end(), found[slot].begin(), found[slot].end());
    found[slot].clear();
    if (release) release(begin + stretch * kStretch);
    return Status();
  };
  // Neither function returns an Error.
  (void)make_in_order((size + kStretch - 1) / kStretch, jobs, find, take).ok();
  return begins;
}

}  // namespace krok::bvh
