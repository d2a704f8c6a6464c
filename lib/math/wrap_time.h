#pragma once

namespace krok {

// What is shown before the beginning and after the end of something that lasts from 0 to
// `duration`.
enum class Wrap : unsigned char {
  clamp,     // the first moment before, the last after
  loop,      // again and again; the end is the beginning of the next round
  ping_pong  // forwards and backwards in turn
};

// The moment in [0, duration] that is shown at `time`; the unit does not matter. loop gives less
// than `duration`, but for times within [0, duration] the time itself. 0 where the duration is not
// positive and finite, where the time is not a number, and where an infinite one goes round.
double wrap_time(double time, double duration, Wrap wrap);

}  // namespace krok
