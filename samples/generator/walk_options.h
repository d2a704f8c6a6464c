#pragma once

#include <cstdint>

#include "core/result.h"
#include "math/transform.h"
#include "samples/generator/actor.h"

namespace krok::samples {

enum class Ground : unsigned char { stairs, slope };

// Lengths in metres, angles in radians.
struct WalkOptions {
  double stature = 1.75;     // 0.5 .. 2.5
  int steps = 8;             // 1 .. 1000
  double step_length = 0.7;  // along the path, heel to heel; >= 0, at most 0.55 of the stature
  double step_width = 0.1;   // between the heels; 0.04 .. 0.5
  double turn = 0;           // heading change per step, positive to the left; at most 0.8
  double rise = 0;           // height gained per step; at most 0.14 of the stature
  Ground ground = Ground::stairs;  // stairs or even slope, for a rise

  // Steps/min, 40 .. 200; 0: from the walk ratio (step length over cadence), which people keep
  // constant over speeds, 0.0064 m/(steps/min) (Sekiya and Nagasaki 1998), clamped to 70 .. 140, on
  // stairs to at least 90.
  double cadence = 0;

  // From standing to standing (the last foot closes beside the other: one more strike than
  // `steps`), or cut out of a steady walk, from the strike before the first step to the strike of
  // the last.
  bool from_standing = false;
  Side first_side = Side::left;  // the foot that makes the first step
  // The walk played backwards in time, which is how people walk backwards but for small differences
  // (Thorstensson, "How is the normal locomotor program modified to produce backward walking?",
  // Exp. Brain Res. 61, 1986). Strikes are what were offs; a turn goes to the other side.
  bool backward = false;

  double rate = 60;  // frames per second, 1 .. 1000

  // Measurement noise: Gaussian, independent per frame and joint, reproducible by the seed.
  double noise_angle = 0;     // standard deviation of the joints' local rotations
  double noise_position = 0;  // standard deviation of the root's position
  std::uint64_t seed = 1;
};

// Codes: walk-option, with the option's name and range in the message.
Status check(const WalkOptions& options);

// Steps/min, as given or computed from the step length.
double cadence_of(const WalkOptions& options);

}  // namespace krok::samples
