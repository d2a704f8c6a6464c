#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// How something goes over from 0 to 1 in time: Penner's easing equations (Programming Macromedia
// Flash MX, 2002, chapter 7), with his constants.

namespace krok::timeline {

enum class Curve : unsigned char {
  linear,
  smooth,    // 3u^2 - 2u^3: at rest at both ends
  smoother,  // 6u^5 - 15u^4 + 10u^3: without acceleration there either
  quad,
  cubic,
  quart,
  sine,
  expo,
  circ,
  back,     // goes beyond by a tenth and comes back
  elastic,  // swings about the end
  bounce    // falls on it and rebounds
};

// Slow at the beginning, at the end, or at both. linear, smooth and smoother are what they are.
enum class Ease : unsigned char { in, out, in_out };

struct Easing {
  Curve curve = Curve::smooth;
  Ease ease = Ease::in_out;

  // 0 for u <= 0, 1 for u >= 1; 0 for what is not a number. Between them back and elastic leave
  // [0, 1], all others rise or, bounce, stay within it.
  double at(double u) const;
};

// "linear", "sine-in", "cubic-out", "back-in-out"; a curve's name alone is its in-out.
std::string easing_name(const Easing& easing);
std::optional<Easing> parse_easing(std::string_view name);

// All names, for messages.
std::vector<std::string> easing_names();

}  // namespace krok::timeline
