#pragma once

#include "core/result.h"
#include "formats/gltf/joint_tracks.h"
#include "scene/skeleton.h"
#include "tracks/reduce_keys.h"

namespace krok::gltf {

// Leaves those keys of `tracks` that choose_keys() chooses: what a viewer shows of them is within
// the tolerance of what it showed of all, at every frame and all over the body. `rest` is the
// skeleton that the tracks were made for. A track that times of its own would make larger keeps all
// its keys. Works on up to `jobs` threads (as in parallel_for), which
// do not change the result. Codes: reduce-tolerance.
Result<Reduction> reduce_tracks(const Skeleton& rest, const ReduceOptions& options, int jobs,
                                JointTracks& tracks);

}  // namespace krok::gltf
