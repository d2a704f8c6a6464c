#pragma once

#include "scene/clip.h"
#include "scene/model.h"

// A forearm with a hand, along +X from the elbow, and a motion that twists it.

namespace krok::samples {

// Metres. Between elbow and wrist the section is a constant ellipse with kForearmSides corners, so
// that its volume, and the volume under linear blend, are known analytically (README.md).
inline constexpr double kForearmLength = 0.25;
inline constexpr double kForearmHeight = 0.035, kForearmWidth = 0.045;  // half axes along Y and Z
inline constexpr int kForearmSides = 96;

// A closed mesh with two joints, "elbow" at (0, 1, 0) and "wrist". Between them the wrist's weight
// rises linearly from 0 to 1; outside, the nearer joint has weight 1.
Model make_forearm();

// Rotates the wrist about +X by one degree per frame, from 0 to 180; 60 fps.
Clip make_twist();

}  // namespace krok::samples
