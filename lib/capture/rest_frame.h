#pragma once

#include <string>

#include "capture/capture.h"
#include "roles/roles.h"
#include "scene/clip.h"

namespace krok {

// Many captures begin with a frame that holds a rest pose and is no part of the motion. keep: it
// stays, and is reported. automatic: it is dropped where it is recognised. drop: the first frame is
// dropped whatever it is.
enum class RestFrame { keep, automatic, drop };

struct RestPose {
  // What the reference pose is, and whether the motion begins in a T-pose that is part of it:
  // "a T-pose; the motion begins in a T-pose".
  std::string reference;
  bool first_frame_is_rest = false;
  std::string reason;  // "frame 0 is a T-pose, 74 degrees away from frame 1"
};

// Looks whether the reference pose is a T-pose, and whether the first frame is a rest pose put in
// front of the motion: the step to the second frame is several times larger than the steps that
// follow, and the first frame is a T-pose or leaves most joints unturned. Needs no more than the
// first dozen frames; of fewer than four nothing is said. `roles` are those of the clip's joints.
RestPose find_rest_pose(const Clip& clip, const RoleMap& roles);

// Drops the first frame of a capture as `wish` says, and tells what was found and done (code
// PREFIX-rest-frame). Returns whether it was dropped.
bool settle_rest_frame(const RestPose& rest, RestFrame wish, const std::string& prefix,
                       const std::string& file_name, Capture& capture);

}  // namespace krok
