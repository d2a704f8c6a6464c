#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "gait/print.h"
#include "gait/step_library.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "terrain/terrain.h"

// Walks along footprints.

namespace krok::gait {

struct WalkOptions {
  double rate = 0;   // frames per second of the result; 0: the libraries'
  double speed = 1;  // of the steps, relative to the library's durations; prints with times win
  bool extrapolate = false;  // steps outside the range of the library's examples
  // Instead of refusing a print that cannot be reached, moves it (and all after it by as much) to
  // the nearest that can.
  bool adapt = false;
  double stretch = 0;        // metres by which a leg may be lengthened in place of a knee pop
  double clearance = 0.015;  // metres of the swing foot over the ground
  int jobs = 1;
};

// One step: the swing foot goes from the print before the stance foot's to the one after it.
struct StepReport {
  int stance = 0;                   // index of the stance print; from the one before it
                                    // to the one after it
  double start = 0, end = 0;        // seconds, strike of the stance foot and of the swing foot
  std::string library;              // name of the library that made it
  std::vector<double> asked, made;  // parameters of that library: metres, radians, seconds
  double moved = 0;                 // metres by which `adapt` moved the print
  double clearance = 0;             // least of the swing foot over the ground, metres
  double pelvis_lowered = 0;        // most, metres
  double leg_extension = 0;         // largest, of the leg's length
  double missed = 0;                // metres by which a foot does not reach its print
  std::string why_moved;            // empty unless moved
};

struct Walk {
  Clip clip;
  MotionKeys keys;  // contacts of heels and balls, keytimes of the gait
  std::vector<GroundedPrint> prints;
  std::vector<StepReport> steps;
  Diagnostics warnings;
};

// Walks along `prints`: the walker stands on the first two, steps from print to print, and comes to
// stand on the last two. Sides alternate.
// Codes: walk-prints, walk-ground, walk-too-long, walk-too-high, walk-too-steep, walk-crossing,
// walk-wall, walk-heading, walk-time, with the number of the print, counted from 1.
Result<Walk> walk(std::span<const StepLibrary> libraries, std::span<const Print> prints,
                  const Terrain& ground, const WalkOptions& options, Progress* progress = nullptr);

}  // namespace krok::gait
