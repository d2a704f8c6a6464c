#pragma once

#include <string>

#include "roles/roles.h"
#include "scene/clip.h"

namespace krok::bvh {

struct RestPose {
  // What the reference pose is, and whether the motion begins in a T-pose that is part of it:
  // "the reference pose is a T-pose".
  std::string reference;
  bool first_frame_is_rest = false;
  std::string reason;  // "frame 0 is a T-pose, and the next is 74 degrees away"
};

// Looks whether the reference pose is a T-pose, and whether the first frame is a rest pose put in
// front of the motion: the step to the second frame is several times larger than the steps that
// follow, and the first frame is a T-pose or leaves most joints unturned. `roles` are those of the
// clip's joints.
RestPose find_rest_pose(const Clip& clip, const RoleMap& roles);

}  // namespace krok::bvh
