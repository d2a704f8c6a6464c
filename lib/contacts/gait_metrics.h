#pragma once

#include <array>
#include <vector>

#include "scene/motion_keys.h"

namespace krok {

// What the keytimes of a gait say of it, over whole cycles: from a strike of a foot to its next one
// with one off in between, under three seconds. Means; 0 where there is no such cycle.
struct GaitMetrics {
  int cycles = 0;                  // of both feet
  double cycle = 0;                // seconds
  double cadence = 0;              // steps a minute
  std::array<double, 2> stance{};  // left, right: how much of the cycle the foot is down, 0 .. 1
  double double_support = 0;       // how much of the cycle both feet are down
};
GaitMetrics gait_metrics(const std::vector<Keytime>& keytimes);

}  // namespace krok
