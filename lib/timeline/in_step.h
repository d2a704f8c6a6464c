#pragma once

#include <optional>

#include "timeline/schedule.h"

namespace krok::timeline {

// Two motions played in step while one goes over into the other.
struct InStep {
  double skipped = 0;                  // play time of the next one with which it begins
  std::vector<double> previous, next;  // play times, evenly spaced over the crossfade
};

struct StepSide {
  const PlayedRange& range;
  const MotionKeys* keys;  // may be null
};

// `previous_play` is the play time of the previous motion where the crossfade begins. The next one
// begins at its first moment that is as far between two keytimes as the previous one is between two
// of the same names. Generic time then goes on at a speed that is the weighted mean of what both
// would have alone (a second of generic time lasts the weighted sum of what it lasts in both, as in
// lib/blend); where keytimes have no counterpart any more both go on by the clock. Nothing where no
// such moment is found.
std::optional<InStep> play_in_step(const StepSide& previous, const StepSide& next,
                                   double previous_play, double duration, const Easing& easing);

}  // namespace krok::timeline
