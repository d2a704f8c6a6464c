#pragma once

#include "contacts/gait_metrics.h"
#include "core/result.h"

namespace krok {

// Whether gait metrics are possible for people who travel at `speed` (metres per second) on legs of
// `leg_length` (metres). Warning gait-implausible, at most one, for the first of: a cadence that
// nobody has (under 25 or over 260 steps per minute); feet that are down for very different parts
// of the cycle (over 0.15); walking without double support, or a run with feet down for most of the
// cycle. People walk up to a Froude number (speed squared over gravity times leg length) of 0.5
// and run above 1 (Alexander 1989); walks have a duty factor over 0.5, runs under 0.5. Walks are
// judged from 0.3 m/s to a Froude number of 0.25. Fewer than two cycles are not judged.
Diagnostics check_gait(const GaitMetrics& metrics, double speed, double leg_length);

}  // namespace krok
