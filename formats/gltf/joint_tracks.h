#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/skeleton.h"
#include "scene/stretch.h"
#include "tracks/reduce_keys.h"

// Converts a clip's joint_to_world transforms to glTF animation tracks: float transforms relative
// to the parent, from which a viewer rebuilds the clip's joint positions.

namespace krok::gltf {

struct JointTrack {
  // The node's transform: the reference pose, relative to the parent.
  Vec3f rest_translation = Vec3f::Zero();
  Quatf rest_rotation = Quatf::Identity();

  // [frames], or empty if the rest value holds for all frames. Successive rotations are in one
  // hemisphere, so that interpolation takes the shorter arc.
  std::vector<Vec3f> translations;
  std::vector<Quatf> rotations;

  // Of stretched joints: [frames], or empty for 1. Where a stretch is not along the axes of any one
  // node, the joint is the child of a node with the values above, and has this rotation itself.
  std::vector<Vec3f> scales;
  std::vector<Quatf> inner_rotations;

  // Whether there are keys for all frames that JointTracks::read gives, in place of those above.
  bool read_translations = false, read_rotations = false;

  // After reduce_tracks(), for tracks with fewer keys than frames: the keys' frames, increasing.
  std::vector<int> translation_frames, rotation_frames;

  // What files hold of the keys, see rounded(): bits of the components of rotations; translations
  // in steps of 2^exponent metres.
  static constexpr int kExact = 32, kShortBits = 16;
  int rotation_bits = kExact, translation_exponent = kExact;
};

struct JointTracks {
  std::vector<float> times;  // [frames], seconds, strictly increasing from 0
  double rate = 0;           // of the frames
  std::optional<RootMotion> removed_root_motion = {};  // of a motion in place, see Provenance
  std::vector<JointTrack> joints;                      // [joints]

  // Of streamed_tracks(): computes the keys and passes them on in the order of the frames, some
  // frames of a joint at a time; of a joint without such keys none.
  using TakeKeys =
      std::function<Status(std::size_t joint, std::size_t first_frame,
                           std::span<const Vec3f> translations, std::span<const Quatf> rotations)>;
  std::function<Status(const TakeKeys& take)> read;

  bool are_stretched() const;  // whether a joint has scales
};

// The tracks of `clip` for a skeleton of the same structure, whose reference pose the nodes get.
//
// Computed in double precision from the root down, relative to the parents' rounded transforms as a
// viewer rebuilds them, so that rounding errors do not accumulate along a chain. A joint gets a
// translation track only if in some frame its world position would be off by more than `tolerance`
// metres without one (it moves relative to its parent, or the clip's orientations are rounded).
// Rotations likewise, with 1e-6 rad.
//
// Code: gltf-times if the rate is so high or the clip so long that two frames have the same time.
Result<JointTracks> joint_tracks(const Skeleton& rest, const Clip& clip, double tolerance = 1e-6);

// As above for frames computed on demand, on `jobs` threads (as in parallel_for), which do not
// affect the result. The source may be traversed more than once, each time from the first frame and
// with release().
Result<JointTracks> joint_tracks(const Skeleton& rest, const FrameSource& source, int jobs,
                                 double tolerance = 1e-6);

// The same keys, computed when they are read, so that those of a long take are not held in memory:
// for files without reduced or encoded keys. The source is traversed once or more beforehand, and
// must outlive the result.
Result<JointTracks> streamed_tracks(const Skeleton& rest, const FrameSource& source, int jobs,
                                    double tolerance = 1e-6);

// As above for joints that are stretched, [frames x joints]; with none, the same. Nodes inherit the
// scales of their parents, so that joints below a flattened one can only be where it puts them;
// `largest_error` gets the largest difference of a transform from the clip's, which is 1e-4 or less
// otherwise (of its matrix: metres, and metres at a metre from the joint).
Result<JointTracks> joint_tracks(const Skeleton& rest, const Clip& clip,
                                 std::span<const Stretch> stretches, double& largest_error);

// The keys that a viewer reads. Rotations of up to 16 bits are whole numbers of 16; in `filtered`
// files, of 4 bits and more, behind the filters of EXT_meshopt_compression, which other bits and
// exponents need.
JointTracks rounded(const JointTracks& tracks, bool filtered);

// Only the rest transforms, no times.
JointTracks rest_tracks(const Skeleton& rest);

// frame / rate for each frame, as floats. Code: gltf-times, as above.
Result<std::vector<float>> key_times(int frames, double rate);

// Removes keys with choose_keys(): what a viewer shows stays within the tolerance of the full
// tracks, at every frame and for all joints. `rest` is the skeleton that the tracks were made for.
// A track keeps all its keys if a separate time accessor would make it larger, none if it stays
// at rest. Uses up to `jobs`
// threads (as in parallel_for), which do not affect the result. Code: reduce-tolerance.
Result<Reduction> reduce_tracks(const Skeleton& rest, const ReduceOptions& options, int jobs,
                                JointTracks& tracks);

// joint_to_world of tracks at any time, as a viewer computes it: each track is interpolated between
// its own keys (rotations by slerp), then scales, rotations and translations are combined down the
// hierarchy. In double precision.
class TrackPoses {
 public:
  // Both must outlive it.
  TrackPoses(std::span<const int> parents, const JointTracks& tracks)
      : parents_(parents), tracks_(tracks) {}

  // At `frame`, which may be between two frames, from 0 to the number of frames - 1;
  // [joints]. Without frames the rest pose. Thread-safe.
  void at(double frame, std::span<Mat4> joint_to_world) const;

 private:
  std::span<const int> parents_;
  const JointTracks& tracks_;
};

}  // namespace krok::gltf
