#pragma once

namespace krok {

// How times before the start and after the end of something that lasts from 0 to `duration` are
// mapped.
enum class Wrap : unsigned char {
  clamp,     // hold the first or last value
  loop,      // repeat; the end is the start of the next cycle
  ping_pong  // alternate forwards and backwards
};

// Maps `time` to [0, duration], in any unit. loop gives less than `duration`, except that times
// within [0, duration] are unchanged. 0 if the duration is not positive and finite, if the time is
// NaN, or if it is infinite and `wrap` is not clamp.
double wrap_time(double time, double duration, Wrap wrap);

}  // namespace krok
