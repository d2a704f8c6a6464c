#pragma once

#include <span>
#include <vector>

#include "gait/foot_paths_internal.h"

// Legs from where the pelvis and the feet are. Used by walk().

namespace krok::gait {

// Metres by which the pelvis must be lowered so that no leg is stretched further than in the blend,
// or than nearly straight.
double lowering_for(const Walker& walker, std::span<const Transform> joint_to_world,
                    const std::array<FootPose, 2>& target);

// A curve at or above `needs` (>= 0) with two derivatives: their maximum within `reach` frames on
// either side, averaged over as many twice.
std::vector<double> smooth_above(std::span<const double> needs, int reach);

struct SolvedLegs {
  double extension = 0;  // largest distance from hip to ankle, of the leg's length
  double missed = 0;     // metres by which a foot does not reach its place
};
// Brings the feet of `pose` to `target`. `joint_to_world`: of the pose; changed with it.
SolvedLegs solve_legs(const Walker& walker, const std::array<FootPose, 2>& target, double stretch,
                      PoseVector& pose, std::span<Transform> joint_to_world);

}  // namespace krok::gait
