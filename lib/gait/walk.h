#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "gait/print.h"
#include "gait/step_library.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/motion_keys.h"
#include "terrain/terrain.h"

// Walks along footprints.

namespace krok::gait {

struct WalkOptions {
  double rate = 0;   // frames per second of the result; 0: the libraries'
  double speed = 1;  // of the steps, relative to the library's durations; prints with times win
  bool extrapolate = false;  // steps outside the range of the library's examples
  // Instead of refusing a print that cannot be reached, moves it to the nearest that can. The
  // prints after it stay where they are, and are moved in turn if they need to be.
  bool adapt = false;
  double stretch = 0;        // metres by which a leg may be lengthened in place of a knee pop
  double clearance = 0.015;  // metres of the swing foot over the ground
  // How much of real steps, which libraries with smoothed weights average, each step takes: 0 none,
  // 1 all that the example differs by from the average, which is that of the style if one was
  // taken. Where steps of several captures meet a little is added to that: of captured walks, 0.85
  // came nearest in arm swing, the hips' vertical speed, jerk, and how much steps vary
  // (tests/walk/measure_style.py).
  double variation = 0.85;
  std::uint64_t seed = 1;  // which of several suitable examples
};

// One step: the swing foot goes from the print before the stance foot's to the one after it.
struct StepReport {
  int stance = 0;                   // index of the stance print; from the one before it
                                    // to the one after it
  double start = 0, end = 0;        // seconds, strike of the stance foot and of the swing foot
  std::string library;              // name of the library that made it
  std::string example;              // name of the one whose style it has, if any
  std::vector<double> asked, made;  // parameters of that library: metres, radians, seconds
  double moved = 0;                 // metres by which `adapt` moved the print
  double clearance = 0;             // least of the swing foot over the ground, metres
  double pelvis_lowered = 0;        // most, metres
  double leg_extension = 0;         // largest, of the leg's length
  double missed = 0;                // metres by which a foot does not reach its print
  std::string why_moved;            // empty unless moved
};

// What is known of a walk once its frames have been made.
struct WalkDetails {
  MotionKeys keys;  // contacts of feet and toes, keytimes of the gait
  std::vector<GroundedPrint> prints;
  std::vector<StepReport> steps;
  Diagnostics warnings;
};

// A walk along `prints`: the walker stands on the first two, steps from print to print, and comes
// to stand on the last two. Sides alternate.
class Walk {
 public:
  // Plans the walk. Libraries and ground must outlive it; the libraries share one skeleton. Codes:
  // walk-library; walk-legs; parametric-skeleton;
  // walk-prints (fewer than three, sides that do not
  // alternate, values out of range); with the number of the print, counted from 1: walk-ground,
  // walk-too-long, walk-too-high, walk-too-steep, walk-crossing, walk-wall, walk-heading,
  // walk-outside, walk-time; clip-too-long.
  static Result<Walk> plan(std::span<const StepLibrary> libraries, std::span<const Print> prints,
                           const Terrain& ground, const WalkOptions& options);

  // Frames are made in blocks of 64 steps, which are kept until they are released; the
  // same however they are divided and on however many threads. Valid as long as the walk.
  const FrameSource& frames() const;

  // After all frames have been read.
  WalkDetails details() const;

 private:
  struct State;
  explicit Walk(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

// All frames at once.
struct WholeWalk {
  Clip clip;
  WalkDetails details;
};
Result<WholeWalk> walk(std::span<const StepLibrary> libraries, std::span<const Print> prints,
                       const Terrain& ground, const WalkOptions& options, int jobs = 1);

}  // namespace krok::gait
