#pragma once

#include <optional>

#include "timeline/schedule.h"

namespace krok::timeline {

// Time alignment of two motions during a crossfade.
struct InStep {
  double skipped = 0;                  // play time at which the next motion starts
  std::vector<double> previous, next;  // play times, evenly spaced over the crossfade
};

struct StepSide {
  const PlayedRange& range;
  const MotionKeys* keys;  // may be null
};

// `previous_play` is the play time of the previous motion at the start of the crossfade. The next
// motion starts at its first moment that has the same generic time between two keytimes of the same
// names; between two strikes ("left_strike") where the other keytimes come in another order, as
// those of a walk and a run do. During the crossfade an interval of generic time lasts the weighted
// sum of its durations in both motions, as in lib/blend; after the last matching keytime both
// motions play at their own speed. Returns nullopt if no such moment exists.
std::optional<InStep> play_in_step(const StepSide& previous, const StepSide& next,
                                   double previous_play, double duration, const Easing& easing);

}  // namespace krok::timeline
