#pragma once

#include <optional>
#include <string>

#include "skin/skin.h"
#include "tools/common/tool.h"

namespace krok {

enum class SkinAs { clip, pose, rig, frames };

struct SkinOptions {
  std::string model, motion;
  SkinAs as = SkinAs::clip;
  SkinMethod method = SkinMethod::linear;  // --as rig has no other
  std::string time;                        // --as pose; a ClipTime, empty for the start
  std::string from, to;  // the part of the motion; ClipTimes, empty for its ends; not --as pose
  int every = 1;         // of the frames; not --as pose
};

// Whether the options have values that fit some file or other.
Status check(const SkinOptions& options);

// Reads a model and a motion, skins, and writes glTF.
Result<int> run_skin(const SkinOptions& options, ToolContext& context);

}  // namespace krok
