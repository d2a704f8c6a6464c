#pragma once

#include <vector>

#include "retarget/retarget.h"
#include "retarget/same_skeleton.h"

// A motion on the character it was captured with: copied, not transferred.

namespace krok::retarget {

// Roots nearer to the hips than this, of a leg's length, are at their place.
inline constexpr double kAtHips = 0.05;

// Exporters whose reference pose is no body's keep no face in it, either: eyes and jaw sit on the
// head as in the first frame of the target's own motion. The joints of which that is so.
std::vector<int> faces_of_motion(const Clip& target, const RoleMap& roles);

// Of the joint in its parent.
Quat turn_in_frame(const Clip& target, int joint, int frame);

// Copies orientations and scales positions, without rounding except by the scale. What the source
// lacks is on its parent as in the reference pose, a face as faces_of_motion() has it; what is
// beside the hips, and roots at their place, goes along with them; other roots stay.
RetargetedFrames copied_frames(const FrameSource& source, const Clip& target, const RoleMap& roles,
                               const SameSkeleton& same);

}  // namespace krok::retarget
