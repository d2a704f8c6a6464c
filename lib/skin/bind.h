#pragma once

#include "core/result.h"
#include "scene/clip.h"
#include "scene/model.h"

// Bringing a model and a motion together.

namespace krok {

// The model bound to the joints of `skeleton`, a motion's, by name: the result has the names, order
// and parents of `skeleton` and the model's own reference pose. Joints that only `skeleton` has
// keep their place relative to their parent; joints that only the model has are dropped, and it is
// an Error (code skin-joint-missing) if they move a vertex. Influences come out normalised, see
// normalize_influences.
Result<Model> bind_to(Model model, const Skeleton& skeleton);

// Warnings where a motion would distort a model that is bound to its skeleton. The model's
// reference pose may be any pose of that skeleton, for bones keep their place in their parents
// whatever the pose is; so each joint's place in its parent is held against the motion's reference
// pose and all its frames. Where even the nearest is more than 1 mm off, either the length differs
// (code skin-proportions: the mesh is stretched) or the direction alone (code skin-reference: the
// joints' frames are not the same). At most one warning of each kind, which names the joint that
// differs most.
Diagnostics reference_differences(const Skeleton& model, const Clip& motion);

}  // namespace krok
