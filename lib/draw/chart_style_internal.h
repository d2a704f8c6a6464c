#pragma once

#include <span>
#include <string>
#include <vector>

#include "draw/motion_charts.h"

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

}  // namespace krok::draw
