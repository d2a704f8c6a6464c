#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/provenance.h"
#include "scene/skeleton.h"

namespace krok {

// A motion: the joint_to_world transforms of a skeleton's joints at evenly spaced times, in Krok's
// coordinate frame (metres, +Y up). Frame i is at time i / rate seconds; n frames last (n - 1) /
// rate.
//
// Positions and orientations are in world space (not relative to the parent), stored frame by
// frame, shape [frames x joints]. Orientations are unit quaternions of either sign.
struct Clip {
  Skeleton skeleton;
  double rate = 30.0;  // frames per second, see check_frame_rate()
  std::vector<Vec3f> positions;
  std::vector<Quatf> orientations;
  Provenance provenance;

  int joint_count() const { return skeleton.joint_count(); }
  int frame_count() const {
    return skeleton.empty() ? 0 : static_cast<int>(positions.size() / skeleton.names.size());
  }
  // Seconds from the first frame to the last; 0 for fewer than two frames.
  double duration() const {
    const int frames = frame_count();
    return frames < 2 ? 0.0 : (frames - 1) / rate;
  }

  void resize(int frames);

  // The joints of one frame, shape [joints].
  std::span<const Vec3f> frame_positions(int frame) const;
  std::span<Vec3f> frame_positions(int frame);
  std::span<const Quatf> frame_orientations(int frame) const;
  std::span<Quatf> frame_orientations(int frame);

  // One frame in double precision, orientations normalised; `joint_to_world` has [joints] elements.
  void get_pose(int frame, std::span<Transform> joint_to_world) const;
  void set_pose(int frame, std::span<const Transform> joint_to_world);
};

// Checks everything documented above: check(skeleton), equal lengths, a whole number of frames, a
// rate of 0.001 to 100,000, finite values, unit orientations (within 1e-3). A clip may have no
// frames.
// Codes: those of check(Skeleton), clip-shape, clip-rate, clip-value.
Status check(const Clip& clip);

// Fills the frames between two valid ones (first < next) by interpolating local transforms:
// positions linearly, orientations by slerp. Preserves bone lengths that are equal at both ends.
void fill_frames_between(Clip& clip, int first, int next);

// A time between two evenly spaced frames: `fraction`, in [0, 1), from frame `before` to the next;
// 0 is the frame itself.
struct FrameMoment {
  int before = 0;
  double fraction = 0;
};

// Finds `time` (seconds) among `frames` frames at i / rate, clamped to them. Times within 1e-9
// frames of a frame give that frame. NaN gives the first frame. Needs at least one frame.
FrameMoment frame_moment(double time, double rate, int frames);

// Frames per second that motions have, from one in a quarter of an hour to those of a ballistic
// camera. Beyond them a loop over frames or seconds does not end and a frame time rounds to 0.
constexpr double kMinRate = 0.001, kMaxRate = 100'000;

// Whether a rate is within these limits. NaN is not. `code` is the error's.
Status check_frame_rate(double rate, std::string code);

// The number of frames at i / rate within `duration` seconds (with a tolerance of a thousandth of a
// frame). Codes: clip-rate, see check_frame_rate(); clip-too-long
// if the clip would have more than 100 million transforms of `joints` joints.
Result<int> frames_within(double duration, double rate, int joints);

}  // namespace krok
