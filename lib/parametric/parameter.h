#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "scene/skeleton.h"

// What is asked of a motion, and measured on it: how long, wide and high a step is, how far it
// turns, how long it lasts, or where any joint is at a keytime.
//
// Measures are taken as seen from the stance foot's footprint at the first keytime: `along` is
// where its toes point, `up` is up, `across` goes to the side of the swing foot. A step to the
// left and its mirror image to the right therefore have the same parameters.

namespace krok::parametric {

enum class Quantity : unsigned char {
  step_length,  // along, from the stance foot's print to the swing foot's; metres
  step_width,   // across, metres; negative where the feet cross
  step_height,  // up, metres
  step_turn,    // of the swing foot's heading, radians, positive to its side
  duration,     // from the first keytime to the last, seconds
  joint         // where a joint is at a keytime, on one axis, metres
};

enum class Direction : unsigned char { across, up, along };

struct Parameter {
  Quantity quantity = Quantity::step_length;
  // Where the swing foot's print is taken or the joint is; index into the library's keytimes.
  int keytime = 0;
  int joint = -1;  // for Quantity::joint
  Direction direction = Direction::along;
  double tolerance = 0;  // what an error of the motion's own parameter is held against; > 0

  bool operator==(const Parameter&) const = default;
};

// "m", "rad" or "s".
std::string_view unit_of(const Parameter& parameter);

// 1 mm, 0.1 degrees, 1 ms.
double usual_tolerance(Quantity quantity);

// "step.length", "step.width", "step.height", "step.turn", "duration", or "LeftHand.up@swing_off".
std::string name_of(const Parameter& parameter, const Skeleton& skeleton,
                    std::span<const std::string> keytimes);

// The parameter of such a name, with the usual tolerance. Steps may name another keytime than the
// last, at which the swing foot's print is taken: "step.length@swing_strike". Code
// parametric-parameter for a joint, axis or keytime that is not there.
Result<Parameter> parse_parameter(std::string_view name, const Skeleton& skeleton,
                                  std::span<const std::string> keytimes);

// Whether joints and keytimes are there, tolerances are positive and no measure is taken twice.
// Code parametric-parameter.
Status check(std::span<const Parameter> parameters, const Skeleton& skeleton,
             std::span<const std::string> keytimes);

}  // namespace krok::parametric
