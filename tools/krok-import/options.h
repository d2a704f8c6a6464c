#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "formats/io/open_capture.h"
#include "formats/io/open_motion.h"
#include "tools/cli/tool.h"

namespace krok::cli::import {

struct Options {
  std::string input;
  std::string skeleton;                  // --skeleton, empty: search for it
  std::string map;                       // --map, empty: none
  std::string model;                     // --save-model, empty: none
  std::string character;                 // --save-character, empty: none
  std::string clip;                      // --clip, empty: see best_animation()
  std::string skin;                      // --skin, empty: the largest skeleton
  std::string cam;                       // --save-cam, empty: none
  std::string camera;                    // --camera, empty: the first
  std::string morphs;                    // --save-morphs, empty: none
  std::string weights;                   // --morph-weights, empty: none
  std::optional<Unit> unit;              // empty: found out
  std::optional<Direction> up, forward;  // empty: found out
  std::string axes_from;                 // --axes-from, empty: from the file
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

// Options common to all readers of captures.
io::CaptureReading read_options(const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads the capture and writes the motion and, if requested, the model; both appear or neither.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::import
