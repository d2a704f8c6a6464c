#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "formats/pc2/pc2.h"
#include "scene/clip.h"
#include "skin/skin.h"
#include "tools/common/command_options.h"

namespace krok::skinning {

enum class As { clip, pose, rig, frames };

// What stands on the command line.
struct Options {
  std::string subject;  // a model or a character
  std::string motion;   // empty: the reference pose
  std::string morphs;   // --morph, empty where none is given
  std::string weights;  // --weights, likewise
  As as = As::clip;
  SkinMethod method = SkinMethod::linear;  // --as rig has no other
  std::string time;                        // --as pose; a ClipTime, empty for the start
  std::string from, to;     // the part of the motion; ClipTimes, empty for its ends; not --as pose
  int every = 1;            // of the frames; not --as pose
  pc2::Up up = pc2::Up::y;  // of a point cache
};

// Whether a path names a character and no model.
bool is_character(const std::string& path);

void declare_options(CommandOptions& command, Options& options);

// Whether the options have values that fit some file or other.
Status check(const Options& options);

// Which frames --from, --to and --every choose of a motion; codes skin-no-frames, skin-time.
struct Range {
  int first = 0, last = 0, every = 1;
};
Result<std::optional<Range>> chosen_range(const Options& options, const Clip& clip);

// The moment of --as pose in seconds; code skin-time.
Result<double> pose_time(const Options& options, const Clip& clip);

}  // namespace krok::skinning
