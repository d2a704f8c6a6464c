#pragma once

#include <functional>
#include <span>

#include "core/result.h"
#include "scene/clip.h"

namespace krok {

// A motion whose frames are produced on demand, so that a long one need not fit in memory.
// Skeleton, rate, positions and orientations are as in Clip.
struct FrameSource {
  Skeleton skeleton;
  double rate = 30.0;
  int frame_count = 0;

  // Reads the frames [first, first + count), which must exist; both spans have the shape
  // [count x joints]. Called from several threads at once. Values pass check(Clip); an Error if a
  // frame cannot be produced.
  std::function<Status(int first, int count, std::span<Vec3f> positions,
                       std::span<Quatf> orientations)>
      read;

  // Optional. Called when the frames before `frame` have been read, so that memory can be released;
  // with increasing numbers in each pass over the frames, by one thread at a time.
  std::function<void(int frame)> release;

  int joint_count() const { return skeleton.joint_count(); }
  // Seconds from the first frame to the last; 0 for fewer than two frames.
  double duration() const { return frame_count < 2 ? 0.0 : (frame_count - 1) / rate; }
};

// Loads all frames on `jobs` threads (as in parallel_for), without provenance.
Result<Clip> load(const FrameSource& source, int jobs);

// Reads the frames in blocks on `jobs` threads and passes them to `use` in order, one block at a
// time: the number of its first frame, and its frames, valid during the call. An Error of the
// source or of `use` ends the pass.
Status for_each_block(const FrameSource& source, int jobs,
                      const std::function<Status(int first, const Clip& block)>& use);

// Reads all frames and drops them: whether each can be read.
Status read_through(const FrameSource& source, int jobs);

// A source of the frames of `clip`, which must outlive it.
FrameSource frames_of(const Clip& clip);

// The part of check(Clip) about values, of whole frames from `first_frame` on. Code clip-value.
Status check_values(const Skeleton& skeleton, int first_frame, std::span<const Vec3f> positions,
                    std::span<const Quatf> orientations);

}  // namespace krok
