#pragma once

#include <functional>
#include <span>

#include "core/result.h"
#include "scene/clip.h"

namespace krok {

// A motion whose frames are made when they are asked for, so that a long one need not be in memory
// as a whole. What Clip says of skeleton, rate, positions and orientations holds here too.
struct FrameSource {
  Skeleton skeleton;
  double rate = 30.0;
  int frame_count = 0;

  // Fills in the frames [first, first + count), which exist; both spans have the shape
  // [count x joints]. Called from several threads at once. The values are as check(Clip) wants
  // them; an Error where a frame cannot be made.
  std::function<Status(int first, int count, std::span<Vec3f> positions,
                       std::span<Quatf> orientations)>
      read;

  // May be empty. Tells that the frames before `frame` were read, so that memory may be given back;
  // called with increasing numbers in each pass over the frames, by one thread at a time.
  std::function<void(int frame)> release;

  int joint_count() const { return skeleton.joint_count(); }
  // Seconds from the first frame to the last; 0 for fewer than two frames.
  double duration() const { return frame_count < 2 ? 0.0 : (frame_count - 1) / rate; }
};

// All of it, read on `jobs` threads (as in parallel_for), without provenance.
Result<Clip> load(const FrameSource& source, int jobs);

// The frames of `clip`, which must outlive the source.
FrameSource frames_of(const Clip& clip);

}  // namespace krok
