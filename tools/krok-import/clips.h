#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/scene.h"
#include "tools/common/tool.h"

// Which of a scene's animations are imported, and under which file names.

namespace krok::import {

struct ChosenClip {
  int animation = -1;
  std::string name;       // the file's, or "animation 3"
  std::string file_name;  // what {clip} stands for: without characters that paths mind, unique
};

// --clip: a name, a number from 0, "all", or empty, which is the first with a warning that lists
// the others. None for a scene without animations. An Error (code import-clip) for a name that
// none has.
Result<std::vector<ChosenClip>> choose_clips(const nodes::Scene& scene, const std::string& wanted,
                                             const std::string& file, ToolContext& context);

// The path for one clip: {clip} stands for its name; a folder gets "{clip}" and `extension` added.
// With `several` clips a path without {clip} is an Error (code usage).
Result<std::string> clip_path(const std::string& pattern, const std::string& option,
                              const ChosenClip& clip, bool several, const std::string& extension);

}  // namespace krok::import
