#pragma once

#include <chrono>

namespace krok::bench {

inline double seconds() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

void arms();
void two_bones();
void whole_bodies();

}  // namespace krok::bench
