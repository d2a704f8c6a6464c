#pragma once

#include "samples/generator/curves.h"

// Joint angles over a stride at free walking speed. The phase runs from 0, the strike of a foot, to
// 1, its next strike; angles in radians. The values are read from published mean curves and rounded
// to the degree. They define the style of the walk; leg angles follow from the footprints.

namespace krok::samples {

// Phases of gait events (Perry and Burnfield, "Gait Analysis"; Winter).
inline constexpr double kFootFlat = 0.10;
inline constexpr double kHeelRise = 0.31;
inline constexpr double kBallRise = 0.48;
inline constexpr double kToeOff = 0.62;

// Knee flexion; peaks of 18 degrees at loading response and 61 degrees in swing (Winter, natural
// cadence).
double knee_flexion(double phase);

// Flexion of the shoulder and the elbow of the same side (Murray, Sepic and Barnard 1967).
double shoulder_flexion(double phase);
double elbow_flexion(double phase);

// The pelvis over the stride of the left foot (Inman, Ralston and Todd; Perry): rotation about the
// vertical, positive when the right side comes forward; list, positive when the right side drops.
double pelvis_rotation(double left_phase);
double pelvis_list(double left_phase);

}  // namespace krok::samples
