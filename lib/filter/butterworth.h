#pragma once

#include <span>
#include <vector>

#include "core/result.h"

// Low-pass filtering of evenly spaced numbers without a shift in time.

namespace krok::filter {

// The usual filter for captured movement (Winter, Biomechanics and Motor Control of Human Movement,
// ch. 3): a Butterworth low-pass run forward, then backward, so that what one pass delays the other
// brings back.
struct Butterworth {
  // Hertz: where the two passes together let half the power through (-3 dB). The design's own
  // corner is put higher by (sqrt(2) - 1)^(-1/order), for each pass takes its share.
  double cutoff = 6;
  int order = 4;  // of the two passes together: 2, 4, 6 or 8
};

// y[i] = b0 x[i] + b1 x[i-1] + b2 x[i-2] - a1 y[i-1] - a2 y[i-2]; gain 1 for a constant.
struct Section {
  double b0 = 1, b1 = 0, b2 = 0, a1 = 0, a2 = 0;
};

// The sections of one pass, by the bilinear transform. Codes: filter-order; filter-cutoff unless
// the cutoff is positive and below half of `rate`.
Result<std::vector<Section>> design(const Butterworth& filter, double rate);

// Filters `series` in place, forward and backward. Each end is continued by `padding` values,
// reflected through the end value (2 x[0] - x[i]), and each pass begins as if its first value had
// stood for ever (Gustafsson 1996 on initial conditions; the same as scipy.signal.sosfiltfilt with
// padlen). `padding` is cut to size - 1; a series of fewer than two values is left as it is.
void filter_both_ways(std::span<const Section> sections, int padding, std::span<double> series);

// A padding after which what the passes remember of their start is below a thousandth: three
// periods of the cutoff.
int padding_for(const Butterworth& filter, double rate);

}  // namespace krok::filter
