#pragma once

#include "core/result.h"
#include "scene/clip.h"

namespace krok {

struct JoinOptions {
  // Seconds that the end of the first motion and the beginning of the second share, the weight
  // going over smoothly (3u^2 - 2u^3). 0: a hard cut, the second's first frame gives way to the
  // first's last.
  double blend = 0.2;
  // Brings the second's height to the first's where they meet, as a climb needs. Otherwise both
  // keep their own floor.
  bool match_height = false;
};

// What was found where the two meet, before anything was blended: the largest angle between the
// same joints' rotations to their parents, in radians.
struct Joined {
  Clip clip;
  int joint_frame = 0;  // the frame that belongs to both, the middle of what they share
  int shared_frames = 1;
  double largest_angle = 0;
  int largest_joint = 0;
};

// The first motion and then the second, which is moved and turned on the ground so that the figure
// stands and faces as the first does in the middle of what they share. The second is resampled to
// the first's rate. Without the shared time the durations add up: n and m frames give n + m - 1,
// less the shared steps. `carrier` is what carrying_joint() gives. Skeleton and provenance are the
// first's. A motion without frames adds nothing.
//
// Codes: motion-skeleton where names, order or parents differ, or the reference poses' offsets by
// more than a hundredth of the figure's extent; motion-blend for a shared time that is negative or
// longer than one of the two; those of resample().
Result<Joined> join(const Clip& first, const Clip& second, int carrier, const JoinOptions& options);

}  // namespace krok
