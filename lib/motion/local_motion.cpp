#include "motion/local_motion.h"

#include <cassert>

#include "core/index.h"
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

namespace {

bool moves(std::size_t joint, const Eigen::AlignedBox3d& box) {
  constexpr double kStill = 1e-4;
  return joint == 0 || (!box.isEmpty() && box.sizes().maxCoeff() > kStill);
}

}  // namespace

std::vector<std::uint8_t> moving_joints(const LocalMotion& motion) {
  std::vector<std::uint8_t> moving(static_cast<std::size_t>(motion.joints), 0);
  for (std::size_t j = 0; j < moving.size(); ++j) {
    Eigen::AlignedBox3d box;
    for (const Vec3& place : motion.joint_positions(static_cast<int>(j))) box.extend(place);
    moving[j] = moves(j, box) ? 1 : 0;
  }
  return moving;
}

Result<std::vector<std::uint8_t>> moving_joints(const FrameSource& source, int jobs) {
  const auto& parents = source.skeleton.parents;
  std::vector<Eigen::AlignedBox3d> boxes(parents.size());
  std::vector<Transform> world(boxes.size()), local(boxes.size());
  const Status status = for_each_block(source, jobs, [&](int, const Clip& block) {
    for (int f = 0; f < block.frame_count(); ++f) {
      block.get_pose(f, world);
      world_to_local(parents, world, local);
      for (std::size_t j = 0; j < boxes.size(); ++j) boxes[j].extend(local[j].position);
    }
    return Status();
  });
  if (!status) return status.error();
  std::vector<std::uint8_t> moving;
  for (std::size_t j = 0; j < boxes.size(); ++j) moving.push_back(moves(j, boxes[j]) ? 1 : 0);
  return moving;
}

}  // namespace krok
