#pragma once

#include <span>

#include "core/result.h"
#include "ik/limits.h"
#include "scene/clip.h"

namespace krok::ik {

struct LearnOptions {
  double margin = 0;  // radians added on every side of what was seen, >= 0
};

// The ranges that the joints of `skeleton` use in motions. The zero of each is the mean of the
// rotations seen; the first swing axis is the direction in which the joint swings most; an ellipse
// is the smallest of the shape of the extremes that holds all that was seen. A joint that turns
// about one axis alone (but for the rounding of floats) becomes a hinge, one that never turns
// (within a twentieth of a degree) is locked, the root is free. Every pose of the motions is within
// the limits, hinges' rounding (under 1e-6 rad) apart.
//
// The clips have the joints of `skeleton` in the same order with the same reference orientations
// (within half a degree): code limits-skeleton. No frames: limits-empty.
Result<Limits> learn_limits(const Skeleton& skeleton, std::span<const Clip* const> clips,
                            const LearnOptions& options = {});

}  // namespace krok::ik
