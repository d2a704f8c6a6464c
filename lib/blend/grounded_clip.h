#pragma once

#include <vector>

#include "motion/ground_frame.h"
#include "pose/packed_pose.h"
#include "scene/clip.h"

namespace krok::blend {

// A motion split into the character's ground frame (position and heading) over time and poses
// relative to it, so that motions along different paths can be blended.
class GroundedClip {
 public:
  // `carrier` comes from carrying_joint(); -1 keeps the poses in world space and the ground frame
  // at the origin. `clip` needs at least one frame and must outlive this.
  GroundedClip(const Clip& clip, int carrier);

  // joint_to_parent; the root is relative to the ground frame.
  const PackedClip& poses() const { return poses_; }

  // The ground frame at `time` seconds, linear between frames; the heading is unwrapped.
  GroundFrame place(double time) const;

  // World position of a joint.
  Vec3 position(int joint, double time) const;

 private:
  const Clip& clip_;
  PackedClip poses_;
  std::vector<GroundFrame> places_;  // [frames], unwrapped headings
};

}  // namespace krok::blend
