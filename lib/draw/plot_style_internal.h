#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "draw/plot.h"

// Private to this folder: the style of plots.

namespace krok::draw {

// Lengths in CSS pixels.
inline constexpr double kTextSize = 12.0;
inline constexpr double kTitleSize = 14.0;  // of a panel
inline constexpr double kChartTitleSize = 16.0;
// A character's width at kTextSize in the wider common sans-serif fonts.
inline constexpr double kCharacter = 7.2;
inline constexpr double kTick = 4.0;
inline constexpr double kLineWidth = 1.6;

// The stroke-dasharray of a series or legend entry; empty for a solid line. `place` is its palette
// index, which selects the pattern if `dash` is negative.
const char* dash_pattern(int dash, std::size_t place);

const std::string& palette_colour(std::size_t place);

// Private to this folder: text and numbers in SVG.

// A coordinate rounded to 1/100 pixel, without trailing zeros.
std::string number(double value);

// Approximate width of a text in common sans-serif fonts, in pixels at kTextSize.
double text_width(std::string_view text);

// `text`, shortened by an ellipsis in the middle if it is wider than `width` pixels at kTextSize.
std::string shortened(const std::string& text, double width);

// Private to this folder: legends.

// Legend entries of the panel's named series.
std::vector<LegendEntry> legend_of(const Panel& panel);

// Lays the entries out in rows of `width` pixels; returns the height. If `out` is null, only
// measures.
double write_legend(const std::vector<LegendEntry>& entries, double left, double top, double width,
                    std::string* out);

}  // namespace krok::draw
