#pragma once

#include <fast_float/fast_float.h>

#include <cmath>
#include <cstddef>
#include <string_view>
#include <system_error>

#include "core/numbers.h"
#include "formats/acclaim/source_text_internal.h"

namespace krok::acclaim {

// Splits one line into words; ends at a comment.
class LineCursor {
 public:
  LineCursor(const char* position, const char* end) : position_(position), end_(end) {}

  bool at_end() {
    while (position_ < end_ && is_separator(*position_)) ++position_;
    return position_ == end_ || *position_ == '#';
  }
  std::string_view word() {
    if (at_end()) return {};
    const char* begin = position_;
    while (position_ < end_ && !is_separator(*position_)) ++position_;
    return {begin, static_cast<std::size_t>(position_ - begin)};
  }
  // Consumes the next word if it is a finite number.
  bool number(double& value) {
    if (at_end()) return false;
    const auto parsed = fast_float::from_chars(position_, end_, value);
    if (parsed.ec == std::errc() && std::isfinite(value) &&
        (parsed.ptr == end_ || is_separator(*parsed.ptr))) {
      position_ = parsed.ptr;
      return true;
    }
    LineCursor ahead = *this;  // has a plus sign, or is not a number
    const auto whole = parse_finite(ahead.word());
    if (!whole) return false;
    value = *whole;
    *this = ahead;
    return true;
  }
  const char* position() const { return position_; }

 private:
  const char* position_;
  const char* end_;
};

}  // namespace krok::acclaim
