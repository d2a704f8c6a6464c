#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/animation_choice.h"
#include "nodes/scene.h"
#include "tools/cli/tool.h"

// Selects the animations of a scene to import, and their file names.

namespace krok::cli::import {

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
