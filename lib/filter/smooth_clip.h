#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <variant>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok::filter {

// Smoothing by a least-squares polynomial of degree `degree` over each window of `window` values,
// evaluated at its middle (Savitzky and Golay, Analytical Chemistry 36, 1964). Preserves peaks
// better than a low-pass of the same strength. The first and last window / 2 values are evaluated
// from the first and last window's polynomial (as scipy.signal.savgol_filter with mode "interp").
struct SavitzkyGolay {
  int window = 9;  // frames, odd
  int degree = 3;  // 0 <= degree < window, at most 12
};

// Codes: filter-window (even, not positive, or over 2001), filter-degree.
Status check(const SavitzkyGolay& filter);

// The weights of a filter, reusable for many series. The filter must pass check().
class PolynomialSmoother {
 public:
  explicit PolynomialSmoother(const SavitzkyGolay& filter);

  // In place. A series shorter than the window is unchanged.
  void smooth(std::span<double> series) const;

 private:
  int window_;
  std::vector<double> weights_;  // [window x window]; row r gives the fitted value at index r
};

// Zero-phase low-pass filtering of evenly sampled values.

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

using Smoothing = std::variant<Butterworth, SavitzkyGolay>;

// Removes jitter per joint: local rotations by smooth_rotations; positions of the root and of
// joints that translate relative to their parents by smooth_positions. Preserves bone lengths,
// timing, frame rate and frame count. Joints with 0 in `joints` keep their local rotation and
// position; an empty span selects all joints. Clips of fewer than three frames, or shorter than the
// window of a SavitzkyGolay, are returned unchanged. Codes: those of the filters.
Result<Clip> smooth(const Clip& clip, const Smoothing& smoothing,
                    std::span<const std::uint8_t> joints, int jobs = 1);

// The same of frames generated on demand, in blocks of `block_frames` with an overlap in which the
// effect of their ends dies away: the same bytes up to one block, beyond it within 1e-6 rad and m.
// Near the first and last frame of a longer take, where a Butterworth's initial state has not died
// away either, it is within 3e-5 (order 8; measured on a noisy walk). The frames are read once
// beforehand, for which joints translate. `watch` (optional) gets each block before and after, one
// at a time.
Result<FrameSource> smooth(
    const FrameSource& source, const Smoothing& smoothing, std::span<const std::uint8_t> joints,
    int jobs, const std::function<void(const FrameRun& before, const Clip& after)>& watch = {},
    int block_frames = BlockSize().frames);

// A linear zero-phase filter of evenly sampled values, in place, that preserves constants.
using SeriesFilter = std::function<void(std::span<double>)>;

// Filters each coordinate of a position separately. The straight line from the first to the last
// position is subtracted before and added back after, so uniform motion is unchanged up to the
// ends.
void smooth_positions(const SeriesFilter& filter, std::span<Vec3> series);

// Filters rotations on the rotation manifold. The curve s(t) is unrolled into a vector space as the
// running sum of its steps log(s(t)^-1 s(t+1)) and filtered there; the difference is applied at
// each sample: s(t) exp(filtered(t) - rolled_out(t)). After Lee and Shin (General Construction of
// Time-Domain Filters for Orientation Data, IEEE Transactions on Visualization and Computer
// Graphics 8(2), 2002). The steps of a noisy curve rotate with its noise, so there are three
// iterations: each unrolls along the previous result s(t) and adds the data's offset log(s(t)^-1
// q(t)) from it.
//
// Properties: filtering a q(t) b gives a filtered(q(t)) b, so the result does not depend on the
// axes of a joint and its parent. A uniform or zero rotation is unchanged. A rotation about a fixed
// axis is filtered like its angle, however large. q and -q are equivalent. Unit quaternions. The
// direction of a step of 180 degrees is ambiguous; one of the two is chosen.
void smooth_rotations(const SeriesFilter& filter, std::span<Quat> series);

}  // namespace krok::filter
