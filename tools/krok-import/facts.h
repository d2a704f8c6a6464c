#pragma once

#include "capture/capture.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "tools/common/tool.h"

// What the report says of an import, whatever the format.

namespace krok::import {

// The median of how high the figure reaches from its lowest joint, over up to a hundred frames; the
// reference pose where there are none.
double height_of(const FrameSource& motion);

Json to_json(const Choice& choice);

// Joints, frames, rate, duration and height of a motion.
Json facts_of(const Clip& clip);
Json facts_of(const FrameSource& motion);

// Unit, up, forward and the reference pose's axes.
Json facts_of(const Conventions& conventions);

// All that is reported of a capture whose frames are `motion`; `details` are those of its format.
Json result_of(const Capture& capture, const FrameSource& motion, const Json& details);

// With -v: what the joints are, a line for each part of the body.
void say_roles(const Skeleton& skeleton, const RoleMap& roles, ToolContext& context);

// "walk.bvh: 52 joints, 90 frames at 30 /s (2.97 s), height 1.71 m".
std::string line_about(const std::string& input, const Clip& clip);
std::string line_about(const std::string& input, const FrameSource& motion);

}  // namespace krok::import
