#pragma once

#include <string>

#include "capture/capture.h"
#include "core/result.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/container/packed_orientation.h"
#include "tools/common/command_options.h"
#include "tools/common/role_input.h"

namespace krok::import {

// What stands on the command line, as text where the library says what it means.
struct Options {
  std::string input;
  std::string skeleton;   // --skeleton, empty where it is to be found
  std::string map;        // --map, empty where none is given
  std::string model;      // --model, empty where none is wanted
  std::string character;  // --character, empty where none is wanted
  std::string clip;       // --clip, empty for the first
  std::string skin;       // --skin, empty for the largest skeleton
  std::string cam;        // --cam, empty where none is wanted
  std::string camera;     // --camera, empty for the first
  std::string morphs;     // --morphs, empty where none are wanted
  std::string weights;    // --morph-weights, likewise
  std::string unit = "auto";
  std::string up = "auto";
  std::string forward = "auto";
  bvh::Positions positions = bvh::Positions::automatic;
  bvh::Angles angles = bvh::Angles::degrees;
  RestFrame rest_frame = RestFrame::keep;
  double fps = 0;       // 0: what the file says
  double resample = 0;  // 0: not at all
  OrientationEncoding orientation = OrientationEncoding::xyz;
  bool strict = false;
  bool repair = false;

  // What joints are, as --map has it; set once that is open.
  FindRoles roles;
};

void declare_options(CommandOptions& command, Options& options);

// The options that all readers share; an Error for a unit or an axis that is none.
Result<CaptureOptions> read_options(const Options& options);

}  // namespace krok::import
