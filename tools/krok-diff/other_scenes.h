#pragma once

#include "compare/scene.h"
#include "core/result.h"
#include "formats/pc2/pc2.h"
#include "scene/clip.h"
#include "scene/model.h"

// Motions, models and point caches as lib/compare sees scenes, so that they can be held against
// glTF. The scenes refer to what they are made of, which must outlive them.

namespace krok::diff {

// Joints without a mesh: an animation with a key at each frame, between them interpolated.
compare::Scene scene_of(const Clip& clip);

// One mesh and the reference pose, without animations.
compare::Scene scene_of(const Model& model);

// Points alone. A point cache tells neither times nor meshes: samples are at the key times of
// `partner`'s first animation where it has as many, otherwise 30 a second, and its points are
// shared out to `partner`'s meshes in their order where these have as many vertices together, or
// are the vertices of each where each has that many. An Error (code pc2-value) for positions that
// are not finite.
Result<compare::Scene> scene_of(const pc2::PointCache& points, const compare::Scene* partner);

}  // namespace krok::diff
