#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "draw/motion_charts.h"
#include "draw/plot.h"

// Private to this folder: styles and helpers shared by the motion charts.

namespace krok::draw {

// Palette indices. The two sides differ in lightness, so they stay distinct in greyscale prints.
inline constexpr int kLeftColour = 0;   // blue
inline constexpr int kRightColour = 4;  // orange

inline int side_colour(Side side) {
  return side == Side::left ? kLeftColour : kRightColour;
}
// The colour of lines that are neither left nor right, for the motion at index `place`.
int motion_colour(std::size_t place);

// Times of the frames shown, in seconds.
std::vector<double> times_of(const ChartedMotion& motion);

// A panel whose x axis covers the times of all motions.
Panel time_panel(std::span<const ChartedMotion> motions, std::string title, std::string label,
                 std::string unit);

// A line in the colour and dash pattern of the motion, or in the colour of a side.
Series motion_line(const ChartedMotion& motion, std::size_t place, std::vector<double> values);
Series side_line(const ChartedMotion& motion, std::size_t place, Side side,
                 std::vector<double> values);

// The side of the foot that a joint belongs to; Side::middle for other joints.
Side side_of_foot(const ChartedMotion& motion, int joint);

// Adds foot contacts as bars in lanes and keytimes as vertical lines.
void add_keys(std::span<const ChartedMotion> motions, bool names, Panel& panel);

// Private to this folder: the style of plots.

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
