#pragma once

#include "compare/scene.h"
#include "core/result.h"
#include "formats/pc2/pc2.h"
#include "scene/clip.h"
#include "scene/model.h"

// Motions, models and point caches as scenes of lib/compare, so that they can be compared with
// glTF. The scenes refer to their sources, which must outlive them.

namespace krok::cli::diff {

// Joints without a mesh: an animation with a key at each frame, interpolated in between.
compare::Scene scene_of(const Clip& clip);

// One mesh and the reference pose, without animations.
compare::Scene scene_of(const Model& model);

// Points only. A point cache has neither times nor meshes: samples are at the key times of
// `partner`'s first animation if the counts match, otherwise at 30 Hz. The points are split among
// `partner`'s meshes in order if these have as many vertices in total, or used for each mesh if
// each has that many. Error (code pc2-value) for positions that are not finite.
Result<compare::Scene> scene_of(const pc2::PointCache& points, const compare::Scene* partner);

}  // namespace krok::cli::diff
