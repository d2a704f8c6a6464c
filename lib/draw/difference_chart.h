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

// Distances between the joints of two motions over time, in world space.
struct MotionDifference {
  std::vector<double> times;         // seconds of the first motion's frames that were compared
  std::vector<double> largest, rms;  // metres over the joints, one value per time
  std::vector<double> largest_turn, rms_turn;  // degrees
  compare::Measure positions, orientations;    // overall: metres, radians; joints of the first
  int joints = 0;                              // number of joints compared
  // Other differences, as sentences: joints that only one has, frame rates, frame counts.
  std::vector<std::string> differences;
};

// Compares the joints that have the same name in both, or only `joints` unless empty, at the shown
// frames of the first motion that have a matching frame in the second (compare::match_frames).
// Error code chart-difference if the two have no joint or no time in common. Both clips must pass
// check().
Result<MotionDifference> difference_over_time(const ChartedMotion& first,
                                              const ChartedMotion& second,
                                              std::span<const std::string> joints);

// The difference of one quantity between two motions over time.
struct ChartedDifference {
  std::string title;                   // "Distance between vertices"
  std::string of;                      // what the max is taken over: "vertices"
  bool is_angle = false;               // degrees; otherwise metres
  std::vector<double> times;           // seconds
  std::vector<double> largest, rms;    // one value per time
  std::optional<double> tolerance;     // drawn as a line
  std::optional<double> worst_moment;  // drawn as a mark, seconds
};

// Plots the max and the RMS. Distances under 10 cm are in millimetres.
Panel difference_panel(const ChartedDifference& difference, Scale scale);

// Distances and angles between joints over time.
std::array<ChartedDifference, 2> difference_charts(const MotionDifference& difference);

// Two panels, distances and angles: max and RMS over all joints. Distances under 10 cm are in
// millimetres.
std::vector<Panel> difference_panels(const MotionDifference& difference, Scale scale);

}  // namespace krok::draw
