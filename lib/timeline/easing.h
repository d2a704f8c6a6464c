#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Easing from 0 to 1: Penner's easing equations (Programming Macromedia Flash MX, 2002, chapter 7),
// with his constants.

namespace krok::timeline {

enum class Curve : unsigned char {
  linear,
  smooth,    // 3u^2 - 2u^3: zero velocity at both ends
  smoother,  // 6u^5 - 15u^4 + 10u^3: zero velocity and acceleration at both ends
  quad,
  cubic,
  quart,
  sine,
  expo,
  circ,
  back,     // overshoots by a tenth
  elastic,  // oscillates around the end value
  bounce    // bounces at the end value
};

// Slow at the start, at the end, or at both. Ignored by linear, smooth and smoother.
enum class Ease : unsigned char { in, out, in_out };

struct Easing {
  Curve curve = Curve::smooth;
  Ease ease = Ease::in_out;

  // 0 for u <= 0, 1 for u >= 1, 0 for NaN. In between, back and elastic leave [0, 1], bounce stays
  // within it, and all others are monotone.
  double at(double u) const;
};

// "linear", "sine-in", "cubic-out", "back-in-out"; a curve name without a suffix means in-out.
std::string easing_name(const Easing& easing);
std::optional<Easing> parse_easing(std::string_view name);

// All names, for messages.
std::vector<std::string> easing_names();

}  // namespace krok::timeline
