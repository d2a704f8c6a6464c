#pragma once

#include <cstdint>

#include "core/result.h"
#include "math/types.h"
#include "samples/generator/actor.h"

namespace krok::samples {

enum class Ground : unsigned char { stairs, slope };

// What kind of walk. Lengths in metres, angles in radians.
struct WalkOptions {
  double stature = 1.75;     // 0.5 .. 2.5
  int steps = 8;             // 1 .. 1000
  double step_length = 0.7;  // along the path, heel to heel; >= 0, at most 0.55 of the stature
  double step_width = 0.1;   // between the heels; 0.04 .. 0.5
  double turn = 0;           // heading gained by each step, to the left; at most 0.8
  double rise = 0;           // height gained by each step; at most 0.14 of the stature
  Ground ground = Ground::stairs;  // whether a rise comes in treads or on an even slope

  // Steps a minute, 40 .. 200; 0: after the walk ratio, step length over cadence, that people keep
  // over speeds, 0.0064 m per step a minute (Sekiya and Nagasaki 1998), between 70 and 140, from 90
  // on stairs.
  double cadence = 0;

  // From standing to standing (the last foot is brought beside the other, one strike more than
  // `steps`), or cut out of a steady walk, from the strike that precedes the first step to the
  // strike of the last.
  bool from_standing = false;
  Side first_side = Side::left;  // the foot that makes the first step

  double rate = 60;  // frames a second, 1 .. 1000

  // Measuring noise: Gaussian, independent for each frame and joint, the same for the same seed.
  double noise_angle = 0;     // standard deviation of the joints' local rotations
  double noise_position = 0;  // standard deviation of the root's position
  std::uint64_t seed = 1;
};

// Codes: walk-option, with the option's name and range in the message.
Status check(const WalkOptions& options);

// Steps a minute, as given or worked out.
double cadence_of(const WalkOptions& options);

}  // namespace krok::samples
