#pragma once

#include <vector>

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

// From joint_to_world over time, as a clip has it, to what glTF animates: transforms relative to
// the parent, as floats, such that a viewer that multiplies them up again puts the joints where the
// clip has them.

namespace krok::gltf {

struct JointTrack {
  // The node's own transform: the reference pose, relative to the parent.
  Vec3f rest_translation = Vec3f::Zero();
  Quatf rest_rotation = Quatf::Identity();

  // [frames], or none where the rest value serves for all frames. Successive rotations lie in one
  // hemisphere, so that a viewer's interpolation takes the shorter arc.
  std::vector<Vec3f> translations;
  std::vector<Quatf> rotations;

  // Where reduce_tracks() has left fewer values than frames: the frames that they belong to,
  // rising.
  std::vector<int> translation_frames, rotation_frames;
};

struct JointTracks {
  std::vector<float> times;        // [frames], seconds, strictly increasing from 0
  std::vector<JointTrack> joints;  // [joints]
};

// The tracks of `clip` on a skeleton of the same structure, whose reference pose the nodes take.
//
// Worked out in doubles from the root down against the rounded transforms of the parents as a
// viewer will rebuild them, so that rounding does not add up along a chain. A joint keeps its rest
// translation unless some frame would leave its world position more than `tolerance` metres off (it
// moves against its parent, or the clip's orientations are rounded); then it gets a track. The same
// for rotations with 1e-6 rad.
//
// An Error (code gltf-times) if the rate is so high or the clip so long that two frames would fall
// on the same time.
Result<JointTracks> joint_tracks(const Skeleton& rest, const Clip& clip, double tolerance = 1e-6);

// The same of frames that are made when they are asked for, on `jobs` threads (as in parallel_for);
// the result does not depend on them. The source's frames may be asked for more than once, from
// the first on each time, and release() is called each time.
Result<JointTracks> joint_tracks(const Skeleton& rest, const FrameSource& source, int jobs,
                                 double tolerance = 1e-6);

// Only the nodes' own transforms and no times.
JointTracks rest_tracks(const Skeleton& rest);

// i / rate of each frame as floats. An Error (code gltf-times) as above.
Result<std::vector<float>> key_times(int frames, double rate);

}  // namespace krok::gltf
