#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/motion_keys.h"
#include "tools/krok-edit/options.h"

// Cutting by gait events: keytimes by name and number.

namespace krok::cli::edit {

// Reads "left_strike" (the first) or "left_strike[2]"; empty for texts that begin like a number.
// Code edit-event for a number that is none or less than 1.
Result<std::optional<EventTime>> parse_event(std::string_view text);

// The time of an event in seconds. Code edit-event if there is none of that name and number.
Result<double> time_of(const EventTime& event, std::span<const Keytime> keytimes);

// A cycle of a gait: from one strike of a foot to its next, as frames.
struct Cycle {
  int first = 0, last = 0;
  std::string name;  // "left_strike"
  int number = 1;    // of the first of the two
  double angle = 0;  // radians, by which poses differ at most at the seam
  int compared = 1;  // cycles that there were to choose from
  int straight = 0;  // of these, that turn by at most 10 degrees
};

// The cycle between frames `first` and `last` whose ends match best in pose and velocity, of those
// that are straight if there are any. Cycles far from the usual length, where a strike was missed,
// and those in which the hips jump do not count. Code edit-cycle if there is none.
Result<Cycle> best_cycle(const Clip& clip, int carrier, std::span<const Keytime> keytimes,
                         CycleFoot foot, int first, int last);

}  // namespace krok::cli::edit
