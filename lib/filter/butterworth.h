#pragma once

#include <span>
#include <vector>

#include "core/result.h"

// Zero-phase low-pass filtering of evenly sampled values.

namespace krok::filter {

// The standard filter for captured motion (Winter, Biomechanics and Motor Control of Human
// Movement, ch. 3): a Butterworth low-pass run forward, then backward, so that the phase shifts
// cancel.
struct Butterworth {
  // Hz: the half-power (-3 dB) frequency of both passes together. The corner of a single pass is
  // higher by the factor (sqrt(2) - 1)^(-1/order).
  double cutoff = 6;
  int order = 4;  // of the two passes together: 2, 4, 6 or 8
};

// y[i] = b0 x[i] + b1 x[i-1] + b2 x[i-2] - a1 y[i-1] - a2 y[i-2]; gain 1 for a constant.
struct Section {
  double b0 = 1, b1 = 0, b2 = 0, a1 = 0, a2 = 0;
};

// The biquad sections of one pass, by the bilinear transform. Codes: filter-order; filter-cutoff
// unless the cutoff is positive and below half of `rate`.
Result<std::vector<Section>> design(const Butterworth& filter, double rate);

// Filters `series` in place, forward and backward. Each end is extended by `padding` values, an odd
// reflection about the end value (2 x[0] - x[i]), and each pass starts in the steady state of its
// first value (Gustafsson 1996 on initial conditions; same as scipy.signal.sosfiltfilt with
// padlen). `padding` is clamped to size - 1; a series of fewer than two values is unchanged.
void filter_both_ways(std::span<const Section> sections, int padding, std::span<double> series);

// A padding of three periods of the cutoff, after which the effect of the initial state is below a
// thousandth.
int padding_for(const Butterworth& filter, double rate);

}  // namespace krok::filter
