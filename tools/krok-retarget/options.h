#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/container/packed_orientation.h"
#include "retarget/retarget.h"
#include "tools/cli/tool.h"

namespace krok::cli::retarget {

// The options as given.
struct Options {
  std::string input;
  std::string onto;
  std::string map;       // of the input's joints; empty: none
  std::string onto_map;  // of the target's joints
  krok::retarget::Feet feet = krok::retarget::Feet::keep;
  std::string scale;                    // empty: ratio of leg lengths
  std::string reference_pose = "auto";  // auto, a frame, or FILE:FRAME
  std::string onto_reference_pose = "auto";
  std::vector<std::string> takes;  // of the input's actor: files, folders, patterns
  std::string alignment;           // of the two skeletons; empty: none
  std::string save_alignment;      // empty: none
  std::string ground;              // what io::open_terrain() takes; empty: none
  std::string contacts = "auto";   // of the input's feet, for `ground`
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// A frame of another motion: FILE:FRAME.
struct PoseOfFile {
  std::string path;
  int frame = 0;
};
// Empty for auto and plain frame numbers.
std::optional<PoseOfFile> pose_of_file(const std::string& text);

// Code usage for invalid values. Poses from files are left to the caller.
Result<krok::retarget::Options> parse(const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::retarget
