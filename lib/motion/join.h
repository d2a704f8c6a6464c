#pragma once

#include "core/result.h"
#include "scene/clip.h"

namespace krok {

struct JoinOptions {
  // Seconds of overlap between the end of the first motion and the start of the second, cross-faded
  // with a smoothstep weight (3u^2 - 2u^3). 0: a hard cut; the first's last frame replaces the
  // second's first.
  double blend = 0.2;
  // Matches the second's height to the first's where they meet, as climbing needs. Otherwise both
  // keep their own floor.
  bool match_height = false;
};

// The joined clip and its seam. `largest_angle` is the largest angle, in radians, between the two
// motions' rotations of a joint relative to its parent at `joint_frame`, before blending.
struct Joined {
  Clip clip;
  int joint_frame = 0;  // the middle frame of the overlap
  int shared_frames = 1;
  double largest_angle = 0;
  int largest_joint = 0;
};

// Appends the second motion to the first. The second is resampled to the first's rate, then moved
// and turned on the ground so that the character's position and heading match the first's in the
// middle of the overlap. Without overlap, n and m frames give n + m - 1 frames; each overlapping
// step removes one. `carrier` is the result of carrying_joint(). Skeleton and provenance are the
// first's. A motion without frames adds nothing.
//
// Codes: motion-skeleton if joint names, order or parents differ, or the reference poses' offsets
// differ by more than 1 % of the skeleton's extent; motion-blend if the overlap is negative, not
// finite, or longer than either motion; those of resample().
Result<Joined> join(const Clip& first, const Clip& second, int carrier, const JoinOptions& options);

}  // namespace krok
