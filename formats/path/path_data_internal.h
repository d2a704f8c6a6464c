#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <string_view>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "core/text.h"
#include "math/transform.h"

// Private to this folder: points of SVG path data.

namespace krok::path_file {

inline constexpr std::size_t kMaxPoints = 4'000'000;

using Affine2 = Eigen::Transform<double, 2, Eigen::Affine>;

// What is wrong, and the byte of the text where it is.
struct DataFault {
  std::size_t offset = 0;
  std::string message;
  std::string code = "path-data";
};

// Appends the points of path data; `to_metres` goes from the file's units to x and z. One subpath.
// Empty if it succeeds. Source: W3C, SVG 2, sections 9.3 and B.2 (elliptical arcs).
std::optional<DataFault> read_path_data(std::string_view data, const Affine2& to_metres,
                                        std::vector<Vec2>& points);

// The same for the points of a polyline.
std::optional<DataFault> read_polyline(std::string_view data, const Affine2& to_metres,
                                       std::vector<Vec2>& points);

// A transform attribute: translate, scale, rotate, skewX, skewY, matrix. Source: W3C, CSS
// Transforms Module Level 1, section 8.
std::optional<DataFault> read_transform(std::string_view text, Affine2& transform);

// The way that an SVG document draws. `fault_place` is the byte where an Error belongs.
Result<std::vector<Vec2>> read_svg(std::string_view text, double metres_per_unit,
                                   const std::string& id, std::size_t& fault_place);

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
