#pragma once

#include "core/result.h"
#include "scene/clip.h"
#include "scene/model.h"

// Binds a model to the skeleton of a motion.

namespace krok {

// The model bound by name to the joints of `skeleton`, that of a motion: the result has the names,
// order and parents of `skeleton` and the model's own reference pose. Joints that only `skeleton`
// has keep their transform relative to the parent; joints that only the model has are dropped,
// which is an Error (code skin-joint-missing) if they influence a vertex. Influences are
// normalised, see normalize_influences.
Result<Model> bind_to(Model model, const Skeleton& skeleton);

// Warns if a motion would distort a model that is bound to its skeleton. The model's reference pose
// may be any pose of that skeleton, since joint offsets do not depend on the pose; so the offset of
// each joint from its parent is compared with the motion's reference pose and all its frames. If
// even the nearest is more than 1 mm off, either the length differs (code skin-proportions: the
// mesh is stretched) or only the direction (code skin-reference: the joint frames differ). At most
// one warning of each kind, for the joint with the largest difference.
Diagnostics reference_differences(const Skeleton& model, const Clip& motion);

}  // namespace krok
