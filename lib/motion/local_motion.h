#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/clip.h"

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

// The same of a motion that is seen in parts.
class LocalBounds {
 public:
  explicit LocalBounds(const Skeleton& skeleton);
  void add(const Clip& part);
  std::vector<std::uint8_t> moving() const;  // as moving_joints()

 private:
  std::vector<Eigen::AlignedBox3d> boxes_;
};

}  // namespace krok
