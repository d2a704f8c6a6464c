#pragma once

#include "scene/model.h"

namespace krok {

// Normalises the influences of every vertex to the form that Model documents and viewers require:
// no joint twice (weights are added), no negative weights, weights in decreasing order (ties by
// joint), unused influences with weight 0 and joint 0, and a sum of 1 up to float rounding. A
// vertex without any positive weight is bound to joint 0. Idempotent up to that rounding. The
// arrays must have the lengths that Model documents.
void normalize_influences(Model& model);

}  // namespace krok
