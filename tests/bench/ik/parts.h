#pragma once

#include <ctime>

#include "ik/solver.h"

namespace krok::bench {

// Processor time of this thread, so that what else the machine does counts for no one.
inline double seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The iterative methods; cyclic descent has no other starts, but more sweeps.
struct Solving {
  const char* name;
  ik::Method method;
  int iterations;
};
constexpr Solving kSolvings[] = {{"damped least squares", ik::Method::least_squares, 50},
                                 {"selectively damped", ik::Method::selectively_damped, 50},
                                 {"cyclic descent", ik::Method::ccd, 500}};

void arms();
void near_singular();
void two_bones();
void whole_bodies();

}  // namespace krok::bench
