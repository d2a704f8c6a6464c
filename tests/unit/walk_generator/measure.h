#pragma once

#include <string>
#include <vector>

#include "samples/generator/walk.h"

// What a motion is measured to do, worked out from its joints alone.

namespace krok::samples::test {

// The world position of a point fixed to a joint, over all frames.
std::vector<Vec3> track(const Clip& clip, const std::string& joint, const Vec3& offset);

// Angles of the left or right leg in the figure's sagittal plane, radians, a value a frame.
struct LegAngles {
  std::vector<double> hip;    // thigh before the vertical
  std::vector<double> knee;   // flexion
  std::vector<double> ankle;  // toes up against the shank, 0 square to it
  double hyperextension = 0;  // the furthest that the knee bends backward
};
LegAngles leg_angles(const Clip& clip, Side side);

const char* joint_side(Side side);  // "Left", "Right"

}  // namespace krok::samples::test
