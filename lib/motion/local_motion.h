#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/clip.h"

namespace krok {

// A clip's transforms relative to the parent (the root's to the world), in doubles, for operations
// that treat joints one by one and keep bone lengths. Shape [joints x frames], joint by joint.
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

// Puts the motion into a clip of the same joints; the clip gets its number of frames.
void set_local_motion(const LocalMotion& motion, Clip& clip);

// For each joint whether its place relative to its parent changes by more than a tenth of a
// millimetre; always true for the root. Shape [joints].
std::vector<std::uint8_t> moving_joints(const LocalMotion& motion);

}  // namespace krok
