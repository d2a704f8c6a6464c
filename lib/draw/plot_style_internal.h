#pragma once

#include <string>

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

}  // namespace krok::draw
