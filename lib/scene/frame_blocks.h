#pragma once

#include <functional>

#include "scene/frame_source.h"

// Operations on a FrameSource whose result is a FrameSource, so that a long take passes through a
// chain of them in bounded memory. The sources share what they need; results do not depend on which
// frames are read together.

namespace krok {

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
