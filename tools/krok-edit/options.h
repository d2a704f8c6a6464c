#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/quantity.h"
#include "core/result.h"
#include "filter/smooth_clip.h"
#include "formats/container/packed_orientation.h"
#include "motion/joint_selection.h"
#include "motion/loop.h"
#include "motion/travel.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"

namespace krok::cli::edit {

// A keytime by its name and which of that name, from 1: left_strike[2].
struct EventTime {
  std::string name;
  int number = 1;
};

// Whose strikes a cycle is between.
enum class CycleFoot : unsigned char { none, either, left, right };

// The options as given.
struct Arguments {
  enum class Filter { none, butterworth, savgol };

  std::string input;
  std::string map;
  // 1. clean
  bool spikes = false;
  double spike_threshold = 6;
  Filter filter = Filter::none;
  OrientationEncoding orientation = OrientationEncoding::xyz;
  std::string cutoff = "6Hz";
  std::optional<int> order;
  int window = 9;
  std::vector<std::string> joints, below;
  bool plant = false;
  std::string contacts = "auto";
  // 2. cut
  std::string from, to, sequences, sequence;
  bool list_sequences = false;
  CycleFoot cycle = CycleFoot::none;
  // 3. mirror
  bool mirror = false;
  // 4. timing
  double speed = 1;
  std::optional<double> resample;
  // 5. append
  std::vector<std::string> append;
  std::string blend = "0.2s";
  bool match_height = false;
  // 6. loop
  bool loop = false;
  std::string loop_blend = "0.2s";
  LoopEnd loop_end = LoopEnd::automatic;
  LoopTurn loop_turn = LoopTurn::automatic;
  LoopClimb loop_climb = LoopClimb::automatic;
  std::optional<int> rounds;
  // 7. root motion
  bool in_place = false, treadmill = false;
  // 8. size
  std::optional<double> scale;
  std::string height;
  // 9. position
  bool at_origin = false, re_orient = false, ground = false;
  std::string heading, turn, move;

  // Whether an option, "--blend", was given; set by declare().
  std::function<bool(const char* option)> given;
};

// The parsed options.
struct Options {
  std::string input;
  std::string map;  // role map file, or empty
  OrientationEncoding orientation = OrientationEncoding::xyz;

  std::optional<double> spike_threshold;
  std::optional<filter::Smoothing> smoothing;
  JointSelection joints;
  bool plant = false;
  std::string contacts;  // a file, "auto" or "find"

  std::optional<ClipTime> from, to;
  std::optional<EventTime> from_event, to_event;  // instead of from and to
  CycleFoot cycle = CycleFoot::none;
  std::string sequences, sequence;
  bool list_sequences = false;

  bool mirror = false;

  double speed = 1;
  std::optional<double> resample;

  std::vector<std::string> append;
  ClipTime append_blend;
  bool match_height = false;

  bool loop = false;
  ClipTime loop_blend;
  LoopOptions looping;
  std::optional<int> rounds;

  std::optional<Travel> removed_travel;

  std::optional<double> scale, height;

  bool at_origin = false, ground = false;
  std::optional<double> heading;
  double turn = 0;
  Vec3 move = Vec3::Zero();
};

// `arguments` keeps a reference to `command`.
void declare(CommandOptions& command, Arguments& arguments);

// Fails (code usage) for an option without effect because the option that it modifies is not given.
Status check_needs(const Arguments& arguments);

// Errors name the option. Code usage for options that exclude each other.
Result<Options> understand(const Arguments& arguments);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::edit
