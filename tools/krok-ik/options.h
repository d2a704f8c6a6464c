#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "ik/goal_motion.h"
#include "tools/cli/tool.h"

namespace krok::cli::ik {

// The options as given on the command line.
struct Arguments {
  std::string input, map;
  std::string goals;                        // a goal file, or empty
  std::vector<std::string> reaches, looks;  // JOINT=X,Y,Z@TIME
  std::string fade = "0.5s";
  std::string ground;                 // what heights of goals are over; empty: the origin
  std::string limits;                 // a file, auto, or empty
  std::vector<std::string> captures;  // to learn limits from
  std::string margin = "0deg";
  std::string write_limits;
  krok::ik::Method method = krok::ik::Method::least_squares;
  std::vector<std::string> stiffness;  // JOINT=NUMBER
  std::optional<int> depth;
  int iterations = 60;
  int restarts = 0;
  std::string tolerance = "0.01mm", angle_tolerance = "0.01deg";
  bool root_moves = false;
  bool plant = false;
  std::string contacts = "auto";
  std::string plot;  // an SVG file, or empty
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// A goal of the command line: a point that a joint is to reach or to look at.
struct PointGoal {
  std::string option, joint;
  krok::ik::Goal::Kind kind = krok::ik::Goal::Kind::position;
  Vec3 target = Vec3::Zero();  // metres
  double from = 0, to = 0;     // seconds, or frames
  bool in_frames = false;
};

struct Stiffness {
  std::string joint;
  double value = 0;
};

// The parsed options.
struct Options {
  Arguments given;
  std::vector<PointGoal> points;
  std::vector<Stiffness> stiffness;
  double fade = 0;  // seconds
  double margin = 0;
  krok::ik::Options solver;

  bool has_goals() const { return !given.goals.empty() || !points.empty(); }
  bool changes_motion() const { return has_goals() || given.plant; }
};

void declare(CommandOptions& command, Arguments& arguments);

// Code usage, and those of quantities; messages name the option.
Result<Options> understand(const Arguments& arguments);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::ik
