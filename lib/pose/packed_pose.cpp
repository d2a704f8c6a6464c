#include "pose/packed_pose.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "pose/pose_kernels_internal.h"

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

namespace {

using pose_detail::Between;
using pose_detail::Kernels;

// Terms per kernel call, which fit on the stack.
constexpr std::size_t kRound = 16;

float blend_with(const Kernels& kernels, std::span<const BlendTerm> terms,
                 std::span<const PoseBlock> reference, std::span<PoseBlock> pose) {
  assert(reference.size() == pose.size());
  std::array<Between, kRound> round;
  std::size_t count = 0;
  bool first = true;
  for (const BlendTerm& term : terms) {
    assert(static_cast<std::size_t>(term.clip->blocks_per_pose()) == pose.size());
    if (term.weight == 0.0f) continue;
    if (count == kRound) {
      kernels.blend(round.data(), count, {first, false}, reference.data(), pose.size(),
                    pose.data());
      first = false;
      count = 0;
    }
    round[count++] = pose_detail::between_frames(*term.clip, term.time, term.weight);
  }
  return std::sqrt(kernels.blend(round.data(), count, {first, true}, reference.data(), pose.size(),
                                 pose.data()));
}

}  // namespace

float blend_poses(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                  std::span<PoseBlock> pose) {
  return blend_with(pose_detail::best_kernels(), terms, reference, pose);
}

float blend_poses_reference(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                            std::span<PoseBlock> pose) {
  return blend_with(pose_detail::scalar_kernels(), terms, reference, pose);
}

void clear_sum(std::span<PoseBlock> sum) {
  for (PoseBlock& block : sum) block = {};
}

void add_to_sum(std::span<const PoseBlock> pose, float weight, std::span<const PoseBlock> reference,
                std::span<PoseBlock> sum) {
  assert(pose.size() == sum.size() && reference.size() == sum.size());
  pose_detail::best_kernels().add(pose.data(), weight, reference.data(), sum.size(), sum.data());
}

float finish_sum(std::span<const PoseBlock> reference, std::span<PoseBlock> sum) {
  assert(reference.size() == sum.size());
  return std::sqrt(pose_detail::best_kernels().blend(nullptr, 0, {false, true}, reference.data(),
                                                     sum.size(), sum.data()));
}

namespace {

using pose_detail::ModelJob;

ModelJob make_job(const LocalPoses& local, std::size_t transforms) {
  const std::size_t joints = local.parents.size();
  const auto blocks = static_cast<std::size_t>(pose_blocks(static_cast<int>(joints)));
  const std::size_t count = blocks == 0 ? 0 : local.poses.size() / blocks;
  assert(local.poses.size() == count * blocks && transforms == count * joints);
  assert(local.scratch.size() >= static_cast<std::size_t>(model_scratch(static_cast<int>(joints))));
  (void)transforms;
  ModelJob job{};
  job.parents = local.parents.data();
  job.joints = joints;
  job.poses = local.poses.data();
  job.count = count;
  job.scratch = local.scratch.data();
  return job;
}

ModelJob make_job(const LocalPoses& local, std::span<Vec3f> positions,
                  std::span<Quatf> orientations) {
  assert(positions.size() == orientations.size());
  ModelJob job = make_job(local, positions.size());
  if (job.count == 0) return job;
  job.positions = positions.data()->data();
  job.orientations = orientations.data()->coeffs().data();
  return job;
}

ModelJob make_job(const LocalPoses& local, std::span<JointMatrix> joint_to_world) {
  ModelJob job = make_job(local, joint_to_world.size());
  job.matrices = joint_to_world.data();
  return job;
}

}  // namespace

void local_to_model(const LocalPoses& local, std::span<Vec3f> positions,
                    std::span<Quatf> orientations) {
  pose_detail::local_to_model_simd(make_job(local, positions, orientations));
}

void local_to_model(const LocalPoses& local, std::span<JointMatrix> joint_to_world) {
  pose_detail::local_to_model_simd(make_job(local, joint_to_world));
}

void local_to_model_reference(const LocalPoses& local, std::span<Vec3f> positions,
                              std::span<Quatf> orientations) {
  pose_detail::local_to_model_scalar(make_job(local, positions, orientations));
}

void local_to_model_reference(const LocalPoses& local, std::span<JointMatrix> joint_to_world) {
  pose_detail::local_to_model_scalar(make_job(local, joint_to_world));
}

}  // namespace krok
