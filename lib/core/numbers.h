#pragma once

#include <optional>
#include <string>
#include <string_view>

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

}  // namespace krok
