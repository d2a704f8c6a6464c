#pragma once

#include <array>
#include <string>
#include <vector>

#include "parametric/cut_steps.h"

// Where the steps of a walk begin and end.

namespace krok::parametric {

struct Strike {
  FootSide side;
  double time;  // seconds
};
std::vector<Strike> strikes_of(const MotionKeys& keys);

struct FoundStep {
  FootSide swing = FootSide::left;
  std::vector<double> times;  // seconds, of keytimes_of() the gait
  std::string fault;          // why it is not a valid step; empty if it is
};

// `carrier`: the joint that carries the motion, see carrying_joint().
std::vector<FoundStep> find_steps(const Clip& clip, int carrier, const MotionKeys& keys,
                                  const CutOptions& options);

// Whether a step between two strikes goes forward, backward, to a side, or turns on the spot. Used
// by cut_steps().

enum class StepDirection : unsigned char { forward, backward, side, turn, in_place };

struct DirectedStep {
  StepDirection direction = StepDirection::in_place;
  // Of a side step or a turn: whether the swing foot is the one on the side that the body goes or
  // turns to. The other foot follows it.
  bool leads = false;
};

// The way of the hips over the step, against where the feet point: the mean heading of the stance
// foot's print at its begin and the swing foot's at its end, in which toes that point outward
// cancel out. Less than 0.15 m, for a leg of 0.86 m, is on the spot, and a turn if the swing foot
// turns by 15 degrees or more from its print before. Forward and backward are within 45 degrees of
// the heading. `feet` are those of the clip's skeleton, [FootSide]; `leg_length` in metres, 0 if
// unknown.
DirectedStep direction_of(const FoundStep& step, const Clip& clip, int carrier,
                          const std::array<FootShape, 2>& feet, double leg_length);

// Why the step is none of that gait, for messages; empty if it is one. Walks and runs go forward or
// on the spot without turning. Starts, stops and stands go anywhere.
std::string wrong_direction(const DirectedStep& step, StepGait gait);

}  // namespace krok::parametric
