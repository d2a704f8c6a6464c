#include "capture/fill_frames.h"

#include <vector>

#include "math/quaternion.h"

namespace krok {

void fill_frames_between(Clip& clip, int first, int next) {
  const std::size_t joints = clip.skeleton.names.size();
  std::vector<Transform> world(joints), before(joints), after(joints), local(joints);
  clip.get_pose(first, world);
  world_to_local(clip.skeleton.parents, world, before);
  clip.get_pose(next, world);
  world_to_local(clip.skeleton.parents, world, after);
  for (int frame = first + 1; frame < next; ++frame) {
    const double t = static_cast<double>(frame - first) / static_cast<double>(next - first);
    for (std::size_t j = 0; j < joints; ++j) {
      local[j].position = before[j].position + t * (after[j].position - before[j].position);
      local[j].orientation = slerp(before[j].orientation, after[j].orientation, t);
    }
    local_to_world(clip.skeleton.parents, local, world);
    clip.set_pose(frame, world);
  }
}

}  // namespace krok
