#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "timeline/played_range.h"
#include "timeline/timeline.h"

// When the base items play; computed without sampling poses.

namespace krok::timeline {

// Play time over result time during a time-aligned crossfade, evenly spaced in [begin, end].
struct TimeWarp {
  double begin = 0, end = 0;
  std::vector<double> play_times;  // at least two, or empty without a warp

  bool holds(double time) const { return !play_times.empty() && begin <= time && time <= end; }
  double at(double time) const;
};

struct ScheduledItem {
  PlayedRange range;
  double begin = 0;      // of the change into it
  double start = 0;      // of the item itself: after `begin` by the duration of a smooth change
  double settled = 0;    // end of the change into it
  double end = 0;        // last time at which it contributes
  double skipped = 0;    // play time at its start, from time alignment
  bool in_step = false;  // whether the change into it is time-aligned by keytimes
  bool has_other_keys = false;  // not, although both have keytimes and it was not ruled out
  bool lacks_keys = false;      // not, since one of them has no keytimes, and it was not ruled out
  TimeWarp in, out;

  // Play time at a result time; may be outside the played range.
  double play_time(double time) const;
  // The inverse: result time of a play time >= `skipped`.
  double time_of(double play) const;
};

// Codes, with the item's location: those of resolve(); timeline-time (an invalid time; an item that
// starts before the previous change ends, is too short, ends before the next one needs it, or ends
// before it starts), timeline-endless (nothing ends an item), timeline-sync (keytime sync requested
// but none in common), timeline-empty.
Result<std::vector<ScheduledItem>> schedule(const Timeline& timeline,
                                            std::span<const Source> sources, double rate);

}  // namespace krok::timeline
