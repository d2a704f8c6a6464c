#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/container/packed_orientation.h"
#include "retarget/retarget.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::retarget {

// The pose that matches the other skeleton's reference pose: a frame of the motion, or of the
// motion in `path`; found out without a frame.
struct MatchingPose {
  std::string path;
  std::optional<int> frame;
};

struct Options {
  std::string input;
  std::string onto;
  std::string map;       // of the input's joints; empty: none
  std::string onto_map;  // of the target's joints
  krok::retarget::Feet feet = krok::retarget::Feet::keep;
  krok::retarget::Touches touches = krok::retarget::Touches::keep;
  std::optional<double> scale;  // empty: ratio of leg lengths
  MatchingPose reference_pose, onto_reference_pose;
  std::vector<std::string> takes;  // of the input's actor: files, folders, patterns
  std::string alignment;           // of the two skeletons; empty: none
  std::string save_alignment;      // empty: none
  GroundChoice ground;             // empty: none
  std::string contacts = "auto";   // of the input's feet, for `ground`
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads the motion and the target, and writes the motion on the target's skeleton. Codes: those of
// the readers, of formats/role_map and of lib/retarget.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::retarget
