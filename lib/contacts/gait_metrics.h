#pragma once

#include <array>
#include <vector>

#include "contacts/sole_points.h"
#include "core/result.h"
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

// Whether gait metrics are possible for people who travel at `speed` (metres per second) on legs of
// `leg_length` (metres). Warning gait-implausible, at most one, for the first of: a cadence that
// nobody has (under 25 or over 260 steps per minute); feet that are down for very different parts
// of the cycle (over 0.15); walking without double support, or a run with feet down for most of the
// cycle. People walk up to a Froude number (speed squared over gravity times leg length) of 0.5
// and run above 1 (Alexander 1989); walks have a duty factor over 0.5, runs under 0.5. Walks are
// judged from 0.3 m/s to a Froude number of 0.25. Fewer than two cycles are not judged.
Diagnostics check_gait(const GaitMetrics& metrics, double speed, double leg_length);

}  // namespace krok
