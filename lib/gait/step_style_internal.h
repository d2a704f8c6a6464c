#pragma once

#include <span>

#include "gait/body_motion_internal.h"

// The style of steps. What weights make of hundreds of examples is their average: nobody's walk. So
// each step of a walk takes what one real step differs by from the blend at that step's own
// parameters: w = w(p) + v (e_i - w(p_i)), with the weights w(p) at the step's parameters, those
// at the parameters of the example i, its own row e_i and the variation v. At p = p_i and v = 1 the
// step is the example; keytimes are the example's as well. Where the weights interpolate the
// examples nothing changes. In a style that was asked for, 1 - v of what its examples near the
// step's parameters differ by in the mean is added: v = 0 is the style's average.

namespace krok::gait {

// Chooses the example of each step and sets its weights. Consecutive steps take examples that go
// on in each other (motion matching on places and velocities where the steps meet: Clavet, "Motion
// Matching and The Road to Next-Gen Animation", GDC 2016) and whose parameters are near those of
// the step, so that a walk follows real walks and keeps to one person's style. The same seed gives
// the same walk.
void choose_styles(std::span<const StepLibrary> libraries, const WalkOptions& options,
                   PlannedWalk& plan);

}  // namespace krok::gait
