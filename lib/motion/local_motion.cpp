#include "motion/local_motion.h"

#include <cassert>

#include "core/rows.h"
#include "math/quaternion.h"

namespace krok {

std::span<Quat> LocalMotion::joint_orientations(int joint) {
  return row_of(orientations, frames, joint);
}
std::span<const Quat> LocalMotion::joint_orientations(int joint) const {
  return row_of(orientations, frames, joint);
}
std::span<Vec3> LocalMotion::joint_positions(int joint) {
  return row_of(positions, frames, joint);
}
std::span<const Vec3> LocalMotion::joint_positions(int joint) const {
  return row_of(positions, frames, joint);
}

Transform LocalMotion::at(int joint, int frame) const {
  const auto f = static_cast<std::size_t>(frame);
  return {joint_positions(joint)[f], joint_orientations(joint)[f]};
}

void LocalMotion::set(int joint, int frame, const Transform& joint_to_parent) {
  const auto f = static_cast<std::size_t>(frame);
  joint_positions(joint)[f] = joint_to_parent.position;
  joint_orientations(joint)[f] = joint_to_parent.orientation;
}

LocalMotion local_motion(const Clip& clip) {
  LocalMotion motion;
  motion.joints = clip.joint_count();
  motion.frames = clip.frame_count();
  motion.positions.resize(clip.positions.size());
  motion.orientations.resize(clip.positions.size());
  std::vector<Transform> world(clip.skeleton.names.size()), local(world.size());
  for (int f = 0; f < motion.frames; ++f) {
    clip.get_pose(f, world);
    world_to_local(clip.skeleton.parents, world, local);
    for (int j = 0; j < motion.joints; ++j) motion.set(j, f, local[static_cast<std::size_t>(j)]);
  }
  return motion;
}

void set_local_motion(const LocalMotion& motion, Clip& clip) {
  assert(motion.joints == clip.joint_count());
  clip.resize(motion.frames);
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < motion.frames; ++f) {
    for (int j = 0; j < motion.joints; ++j) pose[static_cast<std::size_t>(j)] = motion.at(j, f);
    local_to_world(clip.skeleton.parents, pose, pose);
    for (Transform& joint : pose) joint.orientation = normalized_or_identity(joint.orientation);
    clip.set_pose(f, pose);
  }
}

std::vector<std::uint8_t> moving_joints(const LocalMotion& motion) {
  constexpr double kStill = 1e-4;
  std::vector<std::uint8_t> moving(static_cast<std::size_t>(motion.joints), 0);
  for (int j = 0; j < motion.joints; ++j) {
    const auto places = motion.joint_positions(j);
    Eigen::AlignedBox3d box;
    for (const Vec3& place : places) box.extend(place);
    moving[static_cast<std::size_t>(j)] =
        j == 0 || (!box.isEmpty() && box.sizes().maxCoeff() > kStill) ? 1 : 0;
  }
  return moving;
}

}  // namespace krok
