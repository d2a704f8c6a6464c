#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "ik/goal_motion.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::ik {

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

struct Options {
  std::string input, map, character;
  std::string goals;                     // a goal file, or empty
  std::vector<PointGoal> points, looks;  // of --reach and --look-at
  double fade = 0;                       // seconds
  GroundChoice ground;                   // what heights of goals are over; empty: the origin
  bool plant = false;
  std::string contacts;
  std::string limits;                 // a file, auto, or empty
  std::vector<std::string> captures;  // to learn limits from
  double margin = 0;                  // radians
  std::string write_limits;
  krok::ik::Options solver;
  std::vector<Stiffness> stiffness;
  double whole_body = 0;  // how much the trunk takes part, 0 to 1
  std::optional<int> depth;
  bool strict = false;
  std::string plot;  // an SVG file, or empty
  OrientationEncoding orientation = OrientationEncoding::xyz;

  bool has_goals() const { return !goals.empty() || !points.empty() || !looks.empty(); }
  bool changes_motion() const { return has_goals() || plant; }
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads the motion, its goals and limits; writes the motion with the goals brought about. Goals
// that are missed are warnings (ik-missed); with `strict` the exit code is 1 then. Codes: those of
// the readers, of formats/goals, formats/limits and lib/ik; ik-joint for a joint of an option that
// the motion has not.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::ik
