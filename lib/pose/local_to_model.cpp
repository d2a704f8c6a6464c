#include "pose/local_to_model.h"

#include <cassert>

#include "pose/pose_kernels_internal.h"

namespace krok {

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
