#include "motion/sample.h"

#include <algorithm>

#include "math/quaternion.h"
#include "scene/frame_moment.h"

namespace krok {

void sample(const Clip& clip, double time, std::span<Transform> joint_to_world,
            std::span<Transform> scratch) {
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  if (clip.frame_count() == 0) {
    std::copy(clip.skeleton.reference.begin(), clip.skeleton.reference.end(),
              joint_to_world.begin());
    return;
  }
  const auto [before, fraction] = frame_moment(time, clip.rate, clip.frame_count());
  if (fraction == 0) {
    clip.get_pose(before, joint_to_world);
    return;
  }
  const auto world = scratch.subspan(0, joints);
  const auto first = scratch.subspan(joints, joints);
  const auto second = scratch.subspan(2 * joints, joints);
  clip.get_pose(before, world);
  world_to_local(clip.skeleton.parents, world, first);
  clip.get_pose(before + 1, world);
  world_to_local(clip.skeleton.parents, world, second);
  for (std::size_t j = 0; j < joints; ++j) {
    first[j].position += fraction * (second[j].position - first[j].position);
    first[j].orientation = slerp(first[j].orientation, second[j].orientation, fraction);
  }
  local_to_world(clip.skeleton.parents, first, joint_to_world);
}

Result<Clip> resample(const Clip& clip, double rate) {
  const auto frames = frames_within(clip.duration(), rate, clip.joint_count());
  if (!frames) return frames.error();
  Clip result;
  result.skeleton = clip.skeleton;
  result.provenance = clip.provenance;
  result.rate = rate;
  if (clip.frame_count() == 0) return result;
  result.resize(*frames);
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  std::vector<Transform> pose(joints), scratch(3 * joints);
  for (int frame = 0; frame < result.frame_count(); ++frame) {
    const FrameMoment moment = frame_moment(frame / rate, clip.rate, clip.frame_count());
    if (moment.fraction == 0) {
      std::ranges::copy(clip.frame_positions(moment.before), result.frame_positions(frame).begin());
      std::ranges::copy(clip.frame_orientations(moment.before),
                        result.frame_orientations(frame).begin());
      continue;
    }
    sample(clip, frame / rate, pose, scratch);
    result.set_pose(frame, pose);
  }
  return result;
}

}  // namespace krok
