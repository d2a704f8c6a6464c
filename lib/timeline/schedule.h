#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "timeline/played_range.h"
#include "timeline/timeline.h"

// When items of the base are played: worked out without looking at a pose.

namespace krok::timeline {

// Play time by result time during a crossfade in step, evenly spaced from `begin` to `end`.
struct TimeWarp {
  double begin = 0, end = 0;
  std::vector<double> play_times;  // at least two, or none where there is no warp

  bool holds(double time) const { return !play_times.empty() && begin <= time && time <= end; }
  double at(double time) const;
};

struct ScheduledItem {
  PlayedRange range;
  double begin = 0;      // of the change into it
  double start = 0;      // of the item itself: later than `begin` by a smooth change
  double settled = 0;    // when the change into it is over
  double end = 0;        // when it is seen for the last time
  double skipped = 0;    // play time that it begins with, so as to be in step
  bool in_step = false;  // whether the change into it goes by keytimes
  TimeWarp in, out;

  // Seconds of play at a moment of the result; may lie beyond what is played.
  double play_time(double time) const;
  // The inverse: when a play time comes. It is not less than `skipped`.
  double time_of(double play) const;
};

// Codes, with the item's place: those of resolve(); timeline-time (a time that is none, an item
// that begins before the change before it is over, lasts too short or does not reach the next one,
// ends before it begins), timeline-endless (nothing ends an item), timeline-sync (keytimes asked
// for and none in common), timeline-empty.
Result<std::vector<ScheduledItem>> schedule(const Timeline& timeline,
                                            std::span<const Source> sources, double rate);

}  // namespace krok::timeline
