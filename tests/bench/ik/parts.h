#pragma once

#include <ctime>

namespace krok::bench {

// Processor time of this thread, so that what else the machine does counts for no one.
inline double seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void arms();
void two_bones();
void whole_bodies();

}  // namespace krok::bench
