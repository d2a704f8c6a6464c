#pragma once

#include <string>

#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "formats/io/open_capture.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"
#include "tools/shared/role_input.h"

namespace krok::cli::import {

// Command-line options; as text if the library parses them.
struct Options {
  std::string input;
  std::string skeleton;   // --skeleton, empty: search for it
  std::string map;        // --map, empty: none
  std::string model;      // --model, empty: none
  std::string character;  // --character, empty: none
  std::string clip;       // --clip, empty: the one that moves most
  std::string skin;       // --skin, empty: the largest skeleton
  std::string cam;        // --cam, empty: none
  std::string camera;     // --camera, empty: the first
  std::string morphs;     // --morphs, empty: none
  std::string weights;    // --morph-weights, empty: none
  std::string unit = "auto";
  std::string up = "auto";
  std::string forward = "auto";
  std::string axes_from;  // --axes-from, empty: from the file
  bvh::Positions positions = bvh::Positions::automatic;
  bvh::Angles angles = bvh::Angles::degrees;
  RestFrame rest_frame = RestFrame::keep;
  double fps = 0;       // 0: from the file
  double resample = 0;  // 0: no resampling
  OrientationEncoding orientation = OrientationEncoding::xyz;
  bool strict = false;
  bool repair = false;

  // Finds joint roles, with --map if given; set when the map is open.
  io::FindRoles roles;
};

void declare(CommandOptions& command, Options& options);

// Options common to all readers of captures; an Error for an invalid unit or axis.
Result<io::CaptureReading> read_options(const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::import
