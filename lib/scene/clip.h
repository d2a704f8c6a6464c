#pragma once

#include <cstddef>
#include <span>
#include <vector>

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

}  // namespace krok
