#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"

// Conversion between numbers and text, independent of the locale.

namespace krok {

// The whole of `text` as a finite number in decimal or exponent form, with an optional sign ('+'
// too); nullopt for empty text, trailing characters, NaN, infinity or a value out of range.
std::optional<double> parse_finite(std::string_view text);

// The whole of `text` as a decimal integer with an optional sign; nullopt otherwise.
std::optional<long long> parse_integer(std::string_view text);

// The shortest text that parses to the same number.
std::string shortest(double value);
std::string shortest(float value);

// A number for display: `digits` significant digits, no exponent between 1e-4 and 1e9, no trailing
// zeros.
std::string readable(double value, int digits = 6);

// An integer for display: 1234567 as "1,234,567".
std::string grouped(long long value);

// A count for display: "1 frame", "1,500 frames". `many` is the plural; if empty, an s is appended.
std::string counted(long long count, std::string_view one, std::string_view many = {});

// Numbers with units from a command line. The whole text must parse; codes quantity-number,
// quantity-unit.

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
