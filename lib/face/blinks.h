#pragma once

#include <cstdint>
#include <vector>

// Blinks at human intervals.

namespace krok::face {

struct BlinkOptions {
  // Means of adults: 17 a minute at rest, 26 in conversation, 4.5 reading. Source: Bentivoglio et
  // al., Analysis of blink rate patterns in normal subjects (Movement Disorders 12, 1997).
  double per_minute = 26;  // > 0, at most 60
  std::uint64_t seed = 1;
  // The lid closes about twice as fast as it opens. Seconds; Krok's own, within what is measured.
  double closing = 0.08, closed = 0.03, opening = 0.16;
};

// When lids begin to close, seconds from 0, up to `duration`. Intervals are log-normal with the
// wanted mean, as measured ones have a long tail; their spread (sigma 0.5) is Krok's own. The first
// comes after a part of an interval. The same seed gives the same blinks.
std::vector<double> blink_times(double duration, const BlinkOptions& options);

// How far lids are closed, 0 to 1, with continuous velocity.
double blink_at(double seconds, const std::vector<double>& times, const BlinkOptions& options);

}  // namespace krok::face
