#pragma once

#include <string>

#include "draw/plot.h"

// Private to this folder: how plots look.

namespace krok::draw {

// Lengths in CSS pixels.
inline constexpr double kTextSize = 12.0;
inline constexpr double kTitleSize = 14.0;  // of a panel
inline constexpr double kChartTitleSize = 16.0;
// A letter's width at kTextSize in the wider of common sans-serif faces.
inline constexpr double kCharacter = 7.2;
inline constexpr double kTick = 4.0;
inline constexpr double kLineWidth = 1.6;

// A series' or a legend's stroke pattern for stroke-dasharray; empty for a solid line. `place` is
// its place in the palette, which tells the pattern where `dash` is negative.
const char* dash_pattern(int dash, std::size_t place);

const std::string& palette_colour(std::size_t place);

}  // namespace krok::draw
