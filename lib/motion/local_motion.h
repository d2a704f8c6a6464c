#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok {

// A clip's transforms relative to the parent (the root's: to the world) in double precision, for
// operations on single joints that keep bone lengths. Shape [joints x frames], joint-major.
struct LocalMotion {
  int joints = 0;
  int frames = 0;
  std::vector<Quat> orientations;
  std::vector<Vec3> positions;

  std::span<Quat> joint_orientations(int joint);
  std::span<const Quat> joint_orientations(int joint) const;
  std::span<Vec3> joint_positions(int joint);
  std::span<const Vec3> joint_positions(int joint) const;

  Transform at(int joint, int frame) const;
  void set(int joint, int frame, const Transform& joint_to_parent);
};

LocalMotion local_motion(const Clip& clip);

// Writes the motion to a clip with the same joints and sets the clip's frame count.
void set_local_motion(const LocalMotion& motion, Clip& clip);

// 1 for joints whose position relative to the parent varies by more than 0.1 mm, and for the root.
// Shape [joints].
std::vector<std::uint8_t> moving_joints(const LocalMotion& motion);

// The same of frames generated on demand, which are read once. Errors are those of the source.
Result<std::vector<std::uint8_t>> moving_joints(const FrameSource& source, int jobs);

}  // namespace krok
