#pragma once

#include <array>
#include <span>
#include <vector>

#include "roles/roles.h"
#include "timeline/mix.h"

// How fast the hips and the feet go through the world, and how hard they are accelerated.

namespace krok::timeline {

struct TrackedJoints {
  int hips = 0;
  std::vector<int> feet;  // ankles and balls; empty where no role tells
};
TrackedJoints tracked_joints(const RoleMap& roles);

struct PaceNow {
  double value = 0;  // metres a second, or a second squared
  int joint = 0;
};
// By PaceOf, from three successive poses (joint_to_world) at `rate` poses per second; speeds are
// those from the second to the third.
std::array<PaceNow, kPaces> paces_of(const TrackedJoints& joints, std::span<const Transform> before,
                                     std::span<const Transform> now,
                                     std::span<const Transform> next, double rate);

// The 99th percentiles over a motion played at `speed`, seen at `rate` frames per second, by
// PaceOf.
std::array<double, kPaces> usual_paces(const TrackedJoints& joints, const Clip& clip, double speed,
                                       double rate, int jobs);

}  // namespace krok::timeline
