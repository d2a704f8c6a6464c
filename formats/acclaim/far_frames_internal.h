#pragma once

#include <string_view>
#include <vector>

#include "capture/far_values.h"
#include "core/result.h"
#include "formats/acclaim/kinematics_internal.h"
#include "formats/acclaim/motion_file_internal.h"
#include "scene/clip.h"

namespace krok::acclaim {

// Diagnostics for implausibly large values: the first rotation and the first position of `far`,
// each with joint, frame and line. Frames in `far` are indices in the file; `places` maps them to
// frames of the clip. Codes acclaim-far-rotation, acclaim-far-position.
std::vector<Error> far_frame_faults(std::string_view amc_text, const MotionFile& motion,
                                    const Kinematics& kinematics, const FarValues& far,
                                    const Clip& clip, const std::vector<std::size_t>& places);

}  // namespace krok::acclaim
