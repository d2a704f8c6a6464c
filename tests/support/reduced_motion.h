#pragma once

#include <algorithm>

#include "math/hermite.h"
#include "math/quaternion.h"
#include "scene/clip.h"
#include "tracks/reduce_keys.h"

// A clip with the keys that choose_keys() leaves it, sampled as its contract says.

namespace krok::test {

struct ReducedClip {
  Reduction reduction;
  std::vector<int> parents;
  std::vector<double> times;     // of the frames of the clip
  std::vector<Transform> local;  // joint_to_parent, [frames x joints]

  std::size_t key_count() const {
    std::size_t count = 0;
    for (const KeptFrames& joint : reduction.joints) {
      count += joint.position.size() + joint.rotation.size();
    }
    return count;
  }

  // joint_to_world, [joints].
  void pose_at(double time, std::span<Transform> pose) const {
    for (std::size_t j = 0; j < parents.size(); ++j) {
      const auto between = [&](const std::vector<int>& kept, const auto& mix) {
        std::vector<double> key_times;
        for (const int frame : kept) key_times.push_back(times[static_cast<std::size_t>(frame)]);
        const std::size_t k = key_before(key_times, time);
        const std::size_t next = std::min(k + 1, kept.size() - 1);
        const double span = key_times[next] - key_times[k];
        const double part = span > 0 ? std::clamp((time - key_times[k]) / span, 0.0, 1.0) : 0;
        mix(local[static_cast<std::size_t>(kept[k]) * parents.size() + j],
            local[static_cast<std::size_t>(kept[next]) * parents.size() + j], part);
      };
      const KeptFrames& joint = reduction.joints[j];
      between(joint.position, [&](const Transform& from, const Transform& to, double part) {
        pose[j].position = from.position + part * (to.position - from.position);
      });
      between(joint.rotation, [&](const Transform& from, const Transform& to, double part) {
        pose[j].orientation = slerp(from.orientation, to.orientation, part);
      });
    }
    local_to_world(parents, pose, pose);
  }
};

inline Result<ReducedClip> reduce_keys(const Clip& clip, const ReduceOptions& options,
                                       int jobs = 1) {
  ReducedClip result{{}, clip.skeleton.parents, {}, {}};
  const std::size_t joints = result.parents.size();
  std::vector<Transform> world(joints), local(joints);
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, world);
    world_to_local(result.parents, world, local);
    result.times.push_back(f / clip.rate);
    result.local.insert(result.local.end(), local.begin(), local.end());
  }
  auto reduction = choose_keys(result.parents, result.times, result.local, options, jobs);
  if (!reduction) return std::move(reduction).error();
  result.reduction = *std::move(reduction);
  return result;
}

}  // namespace krok::test
