#include "pose/packed_pose.h"

#include <algorithm>
#include <cassert>

#include "core/index.h"
#include "math/quaternion.h"
#include "pose/pose_kernels_internal.h"
#include "scene/frame_moment.h"

namespace krok {

namespace {

constexpr auto kLanes = static_cast<std::size_t>(PoseBlock::kLanes);

void set_joint(const Transform& joint, std::size_t lane, PoseBlock& block) {
  for (int i = 0; i < 3; ++i) block.position[i][lane] = static_cast<float>(joint.position[i]);
  for (int i = 0; i < 4; ++i) {
    block.rotation[i][lane] = static_cast<float>(joint.orientation.coeffs()[i]);
  }
}

void sample_with(const pose_detail::Kernels& kernels, const PackedClip& clip, double time,
                 std::span<PoseBlock> pose) {
  assert(pose.size() == static_cast<std::size_t>(clip.blocks_per_pose()));
  const pose_detail::Between term = pose_detail::between_frames(clip, time, 1.0f);
  if (term.part == 0.0f) {
    std::copy_n(term.before, pose.size(), pose.begin());
  } else {
    kernels.sample(term, pose.size(), pose.data());
  }
}

}  // namespace

void pack_pose(std::span<const Transform> joint_to_parent, std::span<PoseBlock> pose) {
  assert(pose.size() ==
         static_cast<std::size_t>(pose_blocks(static_cast<int>(joint_to_parent.size()))));
  for (std::size_t j = 0; j < pose.size() * kLanes; ++j) {
    Transform joint;
    if (j < joint_to_parent.size()) {
      joint = {joint_to_parent[j].position, normalized_or_identity(joint_to_parent[j].orientation)};
    }
    set_joint(joint, j % kLanes, pose[j / kLanes]);
  }
}

void unpack_pose(std::span<const PoseBlock> pose, std::span<Transform> joint_to_parent) {
  assert(joint_to_parent.size() <= pose.size() * kLanes);
  for (std::size_t j = 0; j < joint_to_parent.size(); ++j) {
    const PoseBlock& block = pose[j / kLanes];
    const std::size_t lane = j % kLanes;
    const auto position = [&](int i) { return static_cast<double>(block.position[i][lane]); };
    const auto rotation = [&](int i) { return static_cast<double>(block.rotation[i][lane]); };
    joint_to_parent[j] = {
        Vec3(position(0), position(1), position(2)),
        normalized_or_identity(Quat(rotation(3), rotation(0), rotation(1), rotation(2)))};
  }
}

std::vector<PoseBlock> packed_reference(const Skeleton& skeleton) {
  std::vector<Transform> local(skeleton.names.size());
  if (!skeleton.empty()) world_to_local(skeleton.parents, skeleton.reference, local);
  std::vector<PoseBlock> pose(static_cast<std::size_t>(pose_blocks(skeleton.joint_count())));
  pack_pose(local, pose);
  return pose;
}

std::span<const PoseBlock> PackedClip::frame(int index) const {
  return row_of(blocks, blocks_per_pose(), index);
}

PackedClip pack_clip(const Clip& clip) {
  PackedClip packed;
  packed.joints = clip.joint_count();
  packed.frames = std::max(clip.frame_count(), 1);
  packed.rate = clip.rate;
  packed.blocks = packed_reference(clip.skeleton);
  if (clip.frame_count() == 0) return packed;
  const auto count = static_cast<std::size_t>(packed.blocks_per_pose());
  packed.blocks.resize(static_cast<std::size_t>(packed.frames) * count);
  std::vector<Transform> world(clip.skeleton.names.size()), local(world.size());
  std::vector<Quat> before(world.size(), Quat(0, 0, 0, 0));
  for (int f = 0; f < packed.frames; ++f) {
    clip.get_pose(f, world);
    world_to_local(clip.skeleton.parents, world, local);
    for (std::size_t j = 0; j < local.size(); ++j) {
      local[j].orientation = before[j] = in_hemisphere_of(before[j], local[j].orientation);
    }
    pack_pose(local, row_of(packed.blocks, packed.blocks_per_pose(), f));
  }
  return packed;
}

namespace pose_detail {

Between between_frames(const PackedClip& clip, double time, float weight) {
  const FrameMoment moment = frame_moment(time, clip.rate, clip.frames);
  const int after = moment.fraction == 0 ? moment.before : moment.before + 1;
  return {clip.frame(moment.before).data(), clip.frame(after).data(),
          static_cast<float>(moment.fraction), weight};
}

}  // namespace pose_detail

void sample_pose(const PackedClip& clip, double time, std::span<PoseBlock> pose) {
  sample_with(pose_detail::best_kernels(), clip, time, pose);
}

void sample_pose_reference(const PackedClip& clip, double time, std::span<PoseBlock> pose) {
  sample_with(pose_detail::scalar_kernels(), clip, time, pose);
}

}  // namespace krok
