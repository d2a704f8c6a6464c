#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/skeleton.h"

// Parameters that are requested of a motion and measured on it: length, width, height, turn and
// duration of a step, or the position of a joint at a keytime.
//
// Measured relative to the stance foot's footprint at the first keytime: `along` is the direction
// of its toes, `up` is up, `across` points to the side of the swing foot. A left step and its
// mirrored right step therefore have the same parameters.

namespace krok::parametric {

enum class Quantity : unsigned char {
  step_length,  // along, from the stance footprint to the swing footprint; metres
  step_width,   // across, metres; negative if the feet cross
  step_height,  // up, metres
  step_turn,    // change of the swing foot's heading, radians, positive to its side
  duration,     // from the first keytime to the last, seconds
  joint,        // position of a joint at a keytime along one axis, metres
  path_turn     // as step_turn, of the direction of travel: without FootShape::toe_out
};

inline bool is_turn(Quantity quantity) {
  return quantity == Quantity::step_turn || quantity == Quantity::path_turn;
}

enum class Direction : unsigned char { across, up, along };

struct Parameter {
  Quantity quantity = Quantity::step_length;
  // When the swing footprint or the joint is measured; index into the library's keytimes.
  int keytime = 0;
  int joint = -1;  // for Quantity::joint
  Direction direction = Direction::along;
  double tolerance = 0;  // accepted error of the measured parameter; > 0

  bool operator==(const Parameter&) const = default;
};

// "m", "rad" or "s".
std::string_view unit_of(const Parameter& parameter);

// 1 mm, 0.1 degrees, 1 ms.
double usual_tolerance(Quantity quantity);

// "step.length", "step.width", "step.height", "step.turn", "step.path_turn", "duration", or
// "LeftHand.up@swing_off".
std::string name_of(const Parameter& parameter, const Skeleton& skeleton,
                    std::span<const std::string> keytimes);

// Parses such a name, with the usual tolerance. Step parameters may name the keytime of the swing
// footprint, by default the last: "step.length@swing_strike". Code: parametric-parameter for an
// unknown joint, axis or keytime.
Result<Parameter> parse_parameter(std::string_view name, const Skeleton& skeleton,
                                  std::span<const std::string> keytimes);

// Whether joints and keytimes exist, tolerances are positive and no parameter is repeated. Code:
// parametric-parameter.
Status check(std::span<const Parameter> parameters, const Skeleton& skeleton,
             std::span<const std::string> keytimes);

}  // namespace krok::parametric
