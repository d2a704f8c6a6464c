#pragma once

#include "scene/model.h"

namespace krok {

// Normalises the influences of every vertex to the form that Model documents and viewers require:
// no joint twice (weights are added), no negative weights, weights in decreasing order (ties by
// joint), unused influences with weight 0 and joint 0, and a sum of 1 up to float rounding. A
// vertex without any positive weight is bound to joint 0. Idempotent up to that rounding. The
// arrays must have the lengths that Model documents.
void normalize_influences(Model& model);

// The most influences with a weight above 0 that a vertex has; at least 1.
int used_influences(const Model& model);

// Keeps the `count` largest influences of each vertex, normalised; influences_per_vertex becomes
// `count` where it is more. Weights are in decreasing order, as Model documents. Returns how many
// vertices lost influences.
int limit_influences(Model& model, int count);

}  // namespace krok
