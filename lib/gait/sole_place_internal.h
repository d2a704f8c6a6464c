#pragma once

#include "gait/plan_prints.h"

// Whether a sole lies on one surface. Used by plan_prints().

namespace krok::gait {

enum class SolePlace : unsigned char {
  whole,          // the sole lies on one surface
  heel_and_ball,  // the toes stand out over a lower edge or a hole
  none            // an edge between heel and ball, or something in the toes' way
};

struct SoleGround {
  SolePlace place = SolePlace::none;
  double height = 0;  // under the heel, metres
};

// Samples the ground under the sole of a print. `near` is the height of the ground thereabouts:
// surfaces far above it are another storey.
SoleGround ground_under_sole(const Print& print, double near, const Terrain& ground,
                             const PlanOptions& options);

}  // namespace krok::gait
