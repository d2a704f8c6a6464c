#pragma once

#include <functional>
#include <span>

#include "math/types.h"

namespace krok::filter {

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
