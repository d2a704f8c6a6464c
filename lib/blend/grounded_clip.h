#pragma once

#include <vector>

#include "motion/ground_frame.h"
#include "pose/packed_pose.h"
#include "scene/clip.h"

namespace krok::blend {

// A motion taken apart: where the figure stands and faces over time, and its poses as seen from
// there. Poses of figures that walk different ways can then be summed.
class GroundedClip {
 public:
  // `carrier` is what carrying_joint() gives; -1 leaves the poses in the world and the figure at
  // the origin. `clip` has a frame or more and must outlive this.
  GroundedClip(const Clip& clip, int carrier);

  // The poses relative to the place, joint_to_parent (the root's to the place).
  const PackedClip& poses() const { return poses_; }

  // The place at `time` seconds, between frames evenly; the heading goes on beyond half turns.
  GroundFrame place(double time) const;

  // A joint's position in the world.
  Vec3 position(int joint, double time) const;

 private:
  const Clip& clip_;
  PackedClip poses_;
  std::vector<GroundFrame> places_;  // [frames], headings without jumps
};

}  // namespace krok::blend
