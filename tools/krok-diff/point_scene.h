#pragma once

#include "core/result.h"
#include "formats/pc2/pc2.h"
#include "scene/scene.h"

// Point caches as scenes, so that they can be compared with glTF and models.

namespace krok::cli::diff {

// Points only. A point cache has neither times nor meshes: samples are at the key times of
// `partner`'s first animation if the counts match, otherwise at 30 Hz. The cache must outlive the
// scene. The points are split among `partner`'s meshes in order if these have as many vertices in
// total, or used for each mesh if each has that many. Error (code pc2-value) for positions that are
// not finite.
Result<Scene> scene_of(const pc2::PointCache& points, const Scene* partner);

}  // namespace krok::cli::diff
