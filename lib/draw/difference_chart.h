#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/measure.h"
#include "core/result.h"
#include "draw/motion_charts.h"

namespace krok::draw {

// How far the joints of two motions are apart, over time, in world space.
struct MotionDifference {
  std::vector<double> times;         // seconds of the first motion's frames that were compared
  std::vector<double> largest, rms;  // metres over the joints, one value a time
  std::vector<double> largest_turn, rms_turn;  // degrees
  compare::Measure positions, orientations;    // over all: metres, radians; joints of the first
  int joints = 0;                              // how many were compared
  // What else differs, sentences for people: joints that only one has, rates, numbers of frames.
  std::vector<std::string> differences;
};

// Compares the joints that have the same name in both, or only `joints` where any are named, at
// frames that belong together (compare::match_frames) and are shown of the first. An Error (code
// chart-difference) if the two have no joint or no moment in common. Both clips must pass check().
Result<MotionDifference> difference_over_time(const ChartedMotion& first,
                                              const ChartedMotion& second,
                                              std::span<const std::string> joints);

// How far apart two things are over time, in one quantity.
struct ChartedDifference {
  std::string title;                   // "Distance between vertices"
  std::string of;                      // whose largest it is: "vertices"
  bool is_angle = false;               // degrees; otherwise metres
  std::vector<double> times;           // seconds
  std::vector<double> largest, rms;    // one value a time
  std::optional<double> tolerance;     // a line
  std::optional<double> worst_moment;  // a mark, seconds
};

// The largest and the root of the mean square. Distances under 10 cm are told in millimetres.
Panel difference_panel(const ChartedDifference& difference, Scale scale);

// Distances and angles between joints over time.
std::array<ChartedDifference, 2> difference_charts(const MotionDifference& difference);

// Two panels, distances and angles: the largest of all joints and the root of the mean square.
// Distances under 10 cm are told in millimetres.
std::vector<Panel> difference_panels(const MotionDifference& difference, Scale scale);

}  // namespace krok::draw
