#pragma once

#include <optional>

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok {

enum class Travel {
  all,   // the character stays at its position in the first frame
  trend  // removes only the straight line from the first frame's position to the last's; sway about
         // it is kept, and a loop stays a loop
};

// The motion without the horizontal travel of `carrier` (see carrying_joint). Heights and rotations
// are unchanged. Ancestors of the carrier that do not travel, such as a root that only places the
// character, are unchanged. So are clips of fewer than two frames.
Clip in_place(const Clip& clip, int carrier, Travel removed);
// The same of frames that are produced on demand, read once beforehand if there are joints above
// the carrier.
Result<FrameSource> in_place(const FrameSource& source, int carrier, Travel removed, int jobs);

// The opposite: the motion with `added` from its first frame on, whole poses moved and turned about
// the carrier's place in the first frame. Where in_place() removed the trend of a straight path, at
// its mean velocity, this gives the motion before. Provenance no longer has a removed root motion.
Clip carried_along(const Clip& clip, int carrier, const RootMotion& added);

// A motion in place carried along at the root motion that its provenance says was taken out of it;
// empty if none was. Feet stay on the ground in it, so it is the one in which steps are judged.
std::optional<Clip> travelling(const Clip& clip, int carrier);

}  // namespace krok
