#pragma once

#include <string>
#include <string_view>

// Private to this folder: text and numbers in SVG.

namespace krok::draw {

// A coordinate rounded to 1/100 pixel, without trailing zeros.
std::string number(double value);

// Approximate width of a text in common sans-serif fonts, in pixels at kTextSize.
double text_width(std::string_view text);

// `text`, shortened by an ellipsis in the middle if it is wider than `width` pixels at kTextSize.
std::string shortened(const std::string& text, double width);

}  // namespace krok::draw
