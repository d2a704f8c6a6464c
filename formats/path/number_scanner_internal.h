#pragma once

#include <optional>
#include <string_view>

#include "core/numbers.h"
#include "core/text.h"

// Private to this folder: numbers as SVG writes them, where "1.5.5-2" are three.

namespace krok::path_file {

class NumberScanner {
 public:
  explicit NumberScanner(std::string_view text) : text_(text) {}

  std::size_t offset() const { return at_; }
  bool at_end() {
    skip_space();
    return at_ >= text_.size();
  }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  char take() { return text_[at_++]; }

  void skip_space() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  }
  // White space and at most one comma.
  void skip_comma() {
    skip_space();
    if (peek() == ',') ++at_;
    skip_space();
  }

  // The number here; empty, without moving, if there is none.
  std::optional<double> number() {
    std::size_t end = at_;
    const auto digits = [&] {
      const std::size_t begin = end;
      while (end < text_.size() && text_[end] >= '0' && text_[end] <= '9') ++end;
      return end - begin;
    };
    const auto is = [&](char c) { return end < text_.size() && text_[end] == c; };
    if (is('+') || is('-')) ++end;
    std::size_t count = digits();
    if (is('.')) {
      ++end;
      count += digits();
    }
    if (count == 0) return std::nullopt;
    const std::size_t mantissa = end;
    if (is('e') || is('E')) {
      ++end;
      if (is('+') || is('-')) ++end;
      if (digits() == 0) end = mantissa;
    }
    const auto value = parse_finite(text_.substr(at_, end - at_));
    if (value) at_ = end;
    return value;
  }

  // An arc's flag: one digit, which need not be separated from what follows.
  std::optional<bool> flag() {
    if (peek() != '0' && peek() != '1') return std::nullopt;
    return take() == '1';
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace krok::path_file
