#pragma once

#include "core/result.h"
#include "formats/gltf/joint_tracks.h"
#include "scene/skeleton.h"
#include "tracks/reduce_keys.h"

namespace krok::gltf {

// Removes keys with choose_keys(): what a viewer shows stays within the tolerance of the full
// tracks, at every frame and for all joints. `rest` is the skeleton that the tracks were made for.
// A track keeps all its keys if a separate time accessor would make it larger, none if it stays
// at rest. Uses up to `jobs`
// threads (as in parallel_for), which do not affect the result. Code: reduce-tolerance.
Result<Reduction> reduce_tracks(const Skeleton& rest, const ReduceOptions& options, int jobs,
                                JointTracks& tracks);

}  // namespace krok::gltf
