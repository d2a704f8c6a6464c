#pragma once

#include <array>
#include <vector>

#include "contacts/sole_points.h"
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

// The whole cycles of a foot that gait metrics count, ascending, seconds.
struct GaitCycle {
  double strike = 0, off = 0, next = 0;  // `next` is its next strike
};
std::vector<GaitCycle> gait_cycles(const std::vector<Keytime>& keytimes, FootSide side);

// From a strike of a foot to the toe-off after it, seconds.
struct StanceTimes {
  double strike = 0, off = 0;
};
// The whole stances of a foot, ascending: strikes without a toe-off before the next are left out.
std::vector<StanceTimes> stance_times(const std::vector<Keytime>& keytimes, FootSide side);

}  // namespace krok
