#pragma once

#include "scene/model.h"

namespace krok {

// Brings the influences of every vertex into the form that Model promises and that viewers insist
// on: no joint twice (their weights are added), no negative weight, weights in falling order (equal
// ones by joint), unused places with weight 0 and joint 0, and a sum of 1 to within the rounding of
// floats. A vertex without any positive weight is bound to joint 0. Idempotent up to that rounding.
// The spans that Model describes must have their promised lengths.
void normalize_influences(Model& model);

}  // namespace krok
