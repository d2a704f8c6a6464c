#pragma once

#include "scene/clip.h"

namespace krok {

enum class Travel {
  all,   // the figure stays where it stands in the first frame
  trend  // only the even part, a straight line from the first frame's place to the last's; what
         // sways about it stays, and a loop stays one
};

// The motion without the horizontal travel of `carrier` (see carrying_joint). Heights and rotations
// stay. Joints above the carrier that do not travel themselves, such as a root that only places the
// figure, stay where they are. Fewer than two frames come back as they are.
Clip in_place(const Clip& clip, int carrier, Travel removed);

}  // namespace krok
