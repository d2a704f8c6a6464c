#pragma once

#include <span>
#include <string>
#include <vector>

#include "draw/motion_charts.h"

// Private to this folder: what charts of motions share.

namespace krok::draw {

// Places in the palette. The two sides differ in lightness, so that grey prints tell them apart.
inline constexpr int kLeftColour = 0;   // blue
inline constexpr int kRightColour = 4;  // orange

inline int side_colour(Side side) {
  return side == Side::left ? kLeftColour : kRightColour;
}
// The colour of what is neither left nor right, for the motion at a place in the list.
int motion_colour(std::size_t place);

// Seconds of the frames shown.
std::vector<double> times_of(const ChartedMotion& motion);

// A panel over the time that any of the motions is shown for.
Panel time_panel(std::span<const ChartedMotion> motions, std::string title, std::string label,
                 std::string unit);

// One motion's line in the colour and pattern of the motion, or of a side.
Series motion_line(const ChartedMotion& motion, std::size_t place, std::vector<double> values);
Series side_line(const ChartedMotion& motion, std::size_t place, Side side,
                 std::vector<double> values);

// The side of the foot that a joint belongs to; middle for other joints.
Side side_of_foot(const ChartedMotion& motion, int joint);

// Contacts of feet as bars in lanes and keytimes as lines across.
void add_keys(std::span<const ChartedMotion> motions, bool names, Panel& panel);

}  // namespace krok::draw
