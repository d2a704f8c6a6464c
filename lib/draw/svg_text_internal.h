#pragma once

#include <string>
#include <string_view>

// Private to this folder: texts and numbers as they stand in an SVG.

namespace krok::draw {

// A coordinate to a hundredth of a pixel, without trailing zeros.
std::string number(double value);

// About how wide a text is in common sans-serif faces, in pixels at kTextSize.
double text_width(std::string_view text);

// `text`, or its beginning and end with an ellipsis between them where it is wider than `width`
// pixels at kTextSize.
std::string shortened(const std::string& text, double width);

}  // namespace krok::draw
