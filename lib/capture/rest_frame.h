#pragma once

#include <string>

#include "capture/capture.h"
#include "roles/roles.h"
#include "scene/clip.h"

namespace krok {

// Many captures start with a rest pose that is not part of the motion. keep: it is kept and
// reported. automatic: it is dropped if detected. drop: the first frame is always dropped.
enum class RestFrame { keep, automatic, drop };

struct RestPose {
  // Kind of the reference pose, and whether the motion starts in a T-pose that is part of it: "a
  // T-pose; the motion starts in a T-pose".
  std::string reference;
  bool first_frame_is_rest = false;  // and no other
  // Frames before the motion: that one, or a T-pose that is held for up to 5, and one on the way
  // from it, as resampling makes. 0: none.
  int frames = 0;
  std::string reason;  // "frame 0 is a T-pose, 74 degrees away from frame 1"
};

// Detects whether the reference pose is a T-pose, and whether the first frame is a rest pose put in
// front of the motion: the step to the second frame is several times larger than the following
// steps, and the first frame is a T-pose or has most joints unrotated. Uses the first 16 frames at
// most; with fewer than four frames, only the reference pose is examined. `roles`: of the clip's
// joints.
RestPose find_rest_pose(const Clip& clip, const RoleMap& roles);

// Drops the first frame of a capture according to `wish`, unless more are a rest pose, and reports
// a rest pose or a dropped frame (code PREFIX-rest-frame). Returns whether it was dropped.
bool settle_rest_frame(const RestPose& rest, RestFrame wish, const std::string& prefix,
                       const std::string& file_name, Capture& capture);

}  // namespace krok
