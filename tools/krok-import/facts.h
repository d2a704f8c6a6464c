#pragma once

#include <string>

#include "formats/io/open_capture.h"
#include "roles/stature.h"
#include "scene/frame_source.h"
#include "tools/cli/tool.h"

// Report contents common to all imported formats.

namespace krok::cli::import {

Json to_json(const Choice& choice);

// Joints, frames, rate, duration and stature of a motion.
Json facts_of(const FrameSource& motion, const RoleMap& roles);

// Unit, up and forward, and the axes of the reference pose.
Json facts_of(const Conventions& conventions);

// The full report of a capture with frames `motion`.
Json result_of(const io::OpenedCapture& opened, const FrameSource& motion);

// With -v: prints joint roles, one line per body part.
void log_roles(const Skeleton& skeleton, const RoleMap& roles, ToolContext& context);

// "walk.bvh: 52 joints, 90 frames at 30 fps (2.97 s), stature 1.71 m"; the size where a body shows
// none.
std::string line_about(const std::string& input, const FrameSource& motion, const RoleMap& roles);

}  // namespace krok::cli::import
