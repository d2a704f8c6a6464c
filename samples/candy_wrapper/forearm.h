#pragma once

#include "scene/clip.h"
#include "scene/model.h"

// A forearm with a hand, along +X from the elbow, and a motion that twists it.

namespace krok::samples {

// Metres. Between elbow and wrist the section is an ellipse, the same all along, with this many
// corners; its volume is known, and with it what linear blend leaves of it (README.md).
inline constexpr double kForearmLength = 0.25;
inline constexpr double kForearmHeight = 0.035, kForearmWidth = 0.045;  // half axes along Y and Z
inline constexpr int kForearmSides = 96;

// A closed surface on two joints, "elbow" at (0, 1, 0) and "wrist": from the one to the other the
// wrist's weight rises evenly from 0 to 1; before and behind, the nearer joint has it all.
Model make_forearm();

// The wrist turns about +X by a degree a frame, from 0 to 180; 60 frames a second.
Clip make_twist();

}  // namespace krok::samples
