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

// Operations on a FrameSource whose result is a FrameSource, so that a long take passes through a
// chain of them in bounded memory. The sources share what they need; results do not depend on which
// frames are read together.

// The frames [first, first + count) of `source`, which must exist.
FrameSource part_of(const FrameSource& source, int first, int count);

// The frames of `source` after `change`, which treats each frame by itself: it gets some frames,
// must keep their number, and is called from several threads at once. The skeleton of the result is
// that of `source`.
FrameSource changed(const FrameSource& source, std::function<Status(Clip& frames)> change);

// joint_to_world with each joint as it is in its parent on average, of at most 32 frames spread
// evenly; empty without frames. Errors are those of the source.
std::vector<Transform> usual_pose(const Clip& clip);
Result<std::vector<Transform>> usual_pose(const FrameSource& source);

// Some frames of a take, with those before and after that an operation looks at.
struct FrameRun {
  Clip clip;
  int first = 0;       // number of the clip's first frame in the take
  int kept_begin = 0;  // of the clip's frames, [kept_begin, kept_end) are the result
  int kept_end = 0;
};

struct BlockSize {
  int frames = 16384;  // at least 1
  int overlap = 0;     // frames before and after each block, fewer at the ends of the take
};

// Passes blocks with their overlap, read on `jobs` threads, to `use` in order.
Status for_each_run(const FrameSource& source, BlockSize size, int jobs,
                    const std::function<Status(const FrameRun& run)>& use);

// The frames of `source` after `change`, which needs their neighbours: blocks are read with their
// overlap on `jobs` threads, changed one at a time and in order, and the last two kept, so frames
// are to be read about in order: a block that is read again later is changed again. A `change` that
// gives the frames another skeleton leaves it to the caller to give it to the result.
FrameSource changed_in_blocks(const FrameSource& source, BlockSize size, int jobs,
                              std::function<Status(FrameRun& run)> change);

}  // namespace krok
