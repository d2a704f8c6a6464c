#pragma once

#include "core/result.h"
#include "scene/model.h"

// Bringing a model and a motion together.

namespace krok {

// The model bound to the joints of `skeleton`, a motion's, by name: the result has the names, order
// and parents of `skeleton` and the model's own reference pose. Joints that only `skeleton` has
// keep their place relative to their parent; joints that only the model has are dropped, and it is
// an Error (code skin-joint-missing) if they move a vertex. Influences come out normalised, see
// normalize_influences.
Result<Model> bind_to(Model model, const Skeleton& skeleton);

// Warnings where the reference poses of two skeletons of the same structure differ by so much that
// a motion for one distorts a mesh of the other: more than 1 mm between a joint and its parent
// (code skin-proportions) or more than 1 degree (code skin-reference). One warning each, which
// names the joint that differs most.
Diagnostics reference_differences(const Skeleton& model, const Skeleton& motion);

}  // namespace krok
