#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/io/open_capture.h"
#include "nodes/animation_choice.h"
#include "nodes/scene.h"
#include "roles/body_frame.h"
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

// Selects the animations of a scene to import, and their file names.

struct ChosenClip {
  int animation = -1;
  std::string name;       // from the file, or "animation 3"
  std::string file_name;  // value of {clip}: safe in paths, unique
  std::string why;        // the reason for the choice; "as given" for a value of --clip
};

// `wanted` is the value of --clip: a name, an index, "all", or empty for `best`, with a
// warning that lists the others. Empty for a scene without animations. Fails (code clip-name) if
// there is no match.
Result<std::vector<ChosenClip>> choose_clips(const nodes::Scene& scene, const std::string& wanted,
                                             const nodes::ChosenAnimation& best,
                                             const std::string& file, ToolContext& context);

// Output path of a clip: replaces {clip} by its name; "{clip}" and `extension` are appended to a
// folder. With `several` clips, a path without {clip} is an Error (code usage).
Result<std::string> clip_path(const std::string& pattern, const std::string& option,
                              const ChosenClip& clip, bool several, const std::string& extension);

}  // namespace krok::cli::import
