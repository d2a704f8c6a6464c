#pragma once

#include <vector>

#include "samples/generator/walk_options.h"

// Positions and times of the footprints.

namespace krok::samples {

// One stance of a foot. Times in seconds of the plan.
struct Footprint {
  Side side = Side::left;
  Vec3 heel = Vec3::Zero();        // position of the heel contact point
  double heading = 0;              // of the foot about +Y, 0 faces +Z, positive to the left
  double slope = 0;                // of the ground in that direction, positive uphill
  Vec3 path_point = Vec3::Zero();  // the walk's midline beside the heel
  double path_heading = 0;
  double step_length = 0;      // from the previous print, along the path; 0 for the first two
  double strike = 0;           // the heel (or the ball, downstairs) comes down
  double flat = 0;             // the whole sole is down
  double heel_rise = 0;        // the heel leaves
  double ball_rise = 0;        // the ball leaves, the foot rolls over the tip of the toes
  double off = 0;              // the tip leaves
  double strike_pitch = 0;     // of the foot to the ground at strike, positive toes up
  double off_pitch = 0;        // of the foot at toe-off, negative
  double off_toe_pitch = 0;    // of the toes at toe-off, negative
  bool first_of_foot = false;  // no step leads to it: the foot starts here
  bool last_of_foot = false;   // no step leads from it
};

struct FootPlan {
  std::vector<Footprint> prints;  // in the order of their strikes, feet alternating
  double step_time = 0;           // seconds from a strike to the next
  double first_time = 0;          // range of the requested walk
  double last_time = 0;
  double rise = 0;
  Ground ground = Ground::stairs;
  double edge_behind_heel = 0;  // metres of tread behind a heel

  // The nominal strike time of print i, also for prints where the foot starts.
  double time_of(int print) const { return print * step_time; }

  // Ground height at a position: treads that begin shortly behind the heels, or a slope.
  double ground_height(const Vec3& place) const;
};

// Plans a walk with valid options. The prints follow a path that starts at the origin (the print
// before the first step) facing +Z: each step goes its length in the direction half-way through its
// turn. For a steady walk, extra prints are planned before the first and after the last, so that
// the ends do not differ from the middle.
FootPlan plan_feet(const WalkOptions& options, const Actor& actor);

// Direction vectors of a heading about +Y.
Vec3 forward_of(double heading);
Vec3 left_of(double heading);

}  // namespace krok::samples
