#pragma once

#include <string_view>

#include "core/result.h"

// Numbers with units from a command line. The whole text must parse; codes quantity-number,
// quantity-unit.

namespace krok {

// Metres from "0.1mm", "5 cm", "1.7m", "3in", "1ft"; without a unit, metres. From 50 on a unit is
// needed: a bare number of that size is hardly ever metres. Code also: quantity-no-unit.
Result<double> parse_length(std::string_view text);

// Metres for what needs a unit, such as a tolerance or a person's height: a bare number would be
// metres, and hardly anybody means those. 0 needs none. `usual` is the unit that the message
// suggests. Code also: quantity-no-unit.
Result<double> parse_length_with_unit(std::string_view text, std::string_view usual = "mm");

// Radians from "15deg", "15°", "0.26rad"; without a unit, degrees.
Result<double> parse_angle(std::string_view text);

// Hertz from "6Hz", "0.5 Hz"; without a unit, hertz.
Result<double> parse_frequency(std::string_view text);

// A time in a clip: "1.5s" or "250ms", without a unit seconds; "120f" is a frame.
struct ClipTime {
  double value = 0;
  bool in_frames = false;
  double seconds(double rate) const { return in_frames ? value / rate : value; }
};
Result<ClipTime> parse_clip_time(std::string_view text);

}  // namespace krok
