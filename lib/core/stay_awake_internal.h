#pragma once

#include <chrono>
#include <thread>

// Spin-waiting for another thread that is about to finish.

namespace krok {

// How long to spin before sleeping: loops often follow each other closely, and waking a core takes
// tens of microseconds.
inline constexpr std::chrono::microseconds kAwake{200};

inline void rest_a_moment() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

// Spins until the condition, which is checked without a lock, holds or until it is time to sleep.
// Yields the core to other programs in between.
template <typename Condition>
void stay_awake_until(const Condition& condition) {
  using Clock = std::chrono::steady_clock;
  constexpr int kLooks = 32;  // checks between two clock reads
  const auto end = Clock::now() + kAwake;
  do {
    for (int i = 0; i < kLooks; ++i) {
      if (condition()) return;
      rest_a_moment();
    }
    std::this_thread::yield();
  } while (Clock::now() < end);
}

}  // namespace krok
