#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "filter/smooth_clip.h"
#include "formats/container/packed_orientation.h"
#include "motion/joint_selection.h"
#include "motion/loop.h"
#include "motion/travel.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::edit {

// A keytime by its name and which of that name, from 1: left_strike[2].
struct EventTime {
  std::string name;
  int number = 1;
};

// Whose strikes a cycle is between.
enum class CycleFoot : unsigned char { none, either, left, right };

enum class Filter : unsigned char { none, butterworth, savgol, by_noise };

// A time of the motion, or a keytime.
struct CutTime {
  ClipTime time;
  std::optional<EventTime> event;  // instead of `time`
};

struct Options {
  std::string input;
  std::string map;  // role map file, or empty
  OrientationEncoding orientation = OrientationEncoding::xyz;
  // 1. clean
  bool spikes = false;
  double spike_threshold = 0;
  Filter filter = Filter::none;
  double cutoff = 0;  // Hz
  int window = 0;     // frames
  std::optional<int> order;
  JointSelection joints;
  bool plant = false;
  std::string contacts;  // a file, "auto" or "find"
  bool game_loop = false;
  // 2. cut
  std::optional<CutTime> from, to;
  CycleFoot cycle = CycleFoot::none;
  std::string sequences, sequence;
  bool list_sequences = false;
  // 3. mirror
  bool mirror = false;
  // 4. timing
  double speed = 1;
  std::optional<double> resample;
  Interpolation interpolation;  // of frames between frames
  // 5. append
  std::vector<std::string> append;
  ClipTime append_blend;
  bool match_height = false;
  // 6. loop
  bool loop = false;
  ClipTime loop_blend;
  LoopOptions looping;  // without its blend
  std::optional<int> rounds;
  // 7. root motion
  bool in_place = false, treadmill = false;
  // 8. size
  std::optional<double> scale, height;  // height in metres
  // 9. position
  bool at_origin = false, re_orient = false, on_ground = false;
  std::optional<double> heading;  // radians
  double turn = 0;
  Vec3 move = Vec3::Zero();
  // 10. ground
  bool settle = false;
  GroundChoice ground;
  std::string model;            // whose mesh is laid on the ground, or empty
  std::optional<double> floor;  // metres

  // None for Filter::none and by_noise.
  std::optional<krok::filter::Smoothing> smoothing() const;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads the motion, applies the requested steps in the order of the help, and writes it.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::edit
