#pragma once

#include <chrono>
#include <thread>

// Waiting for another thread that will be done in a moment.

namespace krok {

// For how long whoever waits looks again and again before it sleeps: loops often follow each other
// closely, and to wake a core takes tens of microseconds.
inline constexpr std::chrono::microseconds kAwake{200};

inline void rest_a_moment() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

// Until the condition, which is looked at without any lock, or until it is time to sleep. Other
// programs that want the core get it meanwhile.
template <typename Condition>
void stay_awake_until(const Condition& condition) {
  using Clock = std::chrono::steady_clock;
  constexpr int kLooks = 32;  // between two looks at the clock
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
