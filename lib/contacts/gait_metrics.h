#pragma once

#include <array>
#include <vector>

#include "scene/motion_keys.h"

namespace krok {

// Gait metrics from keytimes, over whole cycles: from a strike of a foot to its next one with one
// toe-off in between, under three seconds. Means; 0 if there is no such cycle.
struct GaitMetrics {
  int cycles = 0;                  // of both feet
  double cycle = 0;                // seconds
  double cadence = 0;              // steps per minute
  std::array<double, 2> stance{};  // left, right: fraction of the cycle the foot is down, 0 .. 1
  double double_support = 0;       // fraction of the cycle both feet are down
};
GaitMetrics gait_metrics(const std::vector<Keytime>& keytimes);

}  // namespace krok
