#include "motion/sample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok {

namespace {

// A place between two frames; fraction 0 is the frame itself.
struct Moment {
  int before = 0;
  double fraction = 0;
};

Moment moment_at(const Clip& clip, double time) {
  const int last = clip.frame_count() - 1;
  const double wanted = time * clip.rate;
  if (!(wanted > 0)) return {};  // not a number counts as the beginning
  if (wanted >= last) return {last, 0};
  const int before = static_cast<int>(wanted);
  const double fraction = wanted - before;
  // Times that are a frame's own up to rounding give that frame, not a mixture.
  constexpr double kSameFrame = 1e-9;
  if (fraction < kSameFrame) return {before, 0};
  if (fraction > 1.0 - kSameFrame) return {before + 1, 0};
  return {before, fraction};
}

}  // namespace

void sample(const Clip& clip, double time, std::span<Transform> joint_to_world,
            std::span<Transform> scratch) {
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  if (clip.frame_count() == 0) {
    std::copy(clip.skeleton.reference.begin(), clip.skeleton.reference.end(),
              joint_to_world.begin());
    return;
  }
  const auto [before, fraction] = moment_at(clip, time);
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
  if (!std::isfinite(rate) || rate <= 0) {
    return Error("clip-rate", fmt::format("a rate of {} frames a second is not positive", rate));
  }
  Clip result;
  result.skeleton = clip.skeleton;
  result.provenance = clip.provenance;
  result.rate = rate;
  if (clip.frame_count() == 0) return result;
  const double frames = std::floor(clip.duration() * rate + 1e-3) + 1;
  if (frames * clip.joint_count() > 1e8) {
    return Error("clip-too-long", fmt::format("{} frames a second over {} s make {} frames", rate,
                                              clip.duration(), frames));
  }
  result.resize(static_cast<int>(frames));
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  std::vector<Transform> pose(joints), scratch(3 * joints);
  for (int frame = 0; frame < result.frame_count(); ++frame) {
    const Moment moment = moment_at(clip, frame / rate);
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
