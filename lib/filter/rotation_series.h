#pragma once

#include <functional>
#include <span>

#include "math/types.h"

namespace krok::filter {

// A linear filter of evenly spaced numbers, in place, that keeps constants and has no shift.
using SeriesFilter = std::function<void(std::span<double>)>;

// Filters positions, each coordinate by itself. The straight line from the first to the last is
// taken out before and put back after, so that even motion is untouched to the very ends.
void smooth_positions(const SeriesFilter& filter, std::span<Vec3> series);

// Filters rotations as rotations. The curve is rolled out into a vector space, its steps
// log(s(t)^-1 s(t+1)) added up one after the other; there the filter applies as it is; the
// difference it makes is put on at each moment: s(t) exp(filtered(t) - rolled_out(t)). That is the
// construction of Lee and Shin (General Construction of Time-Domain Filters for Orientation Data,
// IEEE Transactions on Visualization and Computer Graphics 8(2), 2002). Steps of a noisy curve turn
// with its noise, so the curve along which data is rolled out is the filtered one of the round
// before, the data standing off from it by log(s(t)^-1 q(t)); three rounds are made.
//
// What this keeps: filtering a q(t) b gives a times the filtered q times b (the result does not
// depend on the frames that a joint and its parent are given in); a uniform rotation, at rest or
// not, is untouched; a rotation about a fixed axis is filtered as its angle is, whatever that is.
// q and -q are the same. Unit quaternions; steps of half a turn have no direction that could be
// known, and are taken one of the two ways.
void smooth_rotations(const SeriesFilter& filter, std::span<Quat> series);

}  // namespace krok::filter
