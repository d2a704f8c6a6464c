#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>

#include "core/parallel.h"

namespace krok {

// Runs work(i) for i in [0, count) on up to `threads` threads and passes each outcome to take(i,
// outcome) in order of i, one at a time, on any of the threads. Work starts in order, at most
// `window` items ahead of the first one not taken, which bounds the outcomes in memory. Once take
// returns false, no work is started and nothing is taken; running work finishes. The same holds
// after an exception, which is rethrown.
template <typename Outcome>
void in_order(std::size_t count, int threads, std::size_t window,
              const std::function<Outcome(std::size_t)>& work,
              const std::function<bool(std::size_t, Outcome)>& take) {
  std::mutex mutex;
  std::condition_variable taken_one;
  std::size_t next = 0, taken = 0;
  bool stopped = false, someone_takes = false;
  std::map<std::size_t, Outcome> waiting;

  // Other threads keep working meanwhile and leave their outcomes to the taking thread.
  const auto take_what_is_due = [&](std::unique_lock<std::mutex>& lock) {
    someone_takes = true;
    while (!stopped && !waiting.empty() && waiting.begin()->first == taken) {
      auto due = waiting.extract(waiting.begin());
      lock.unlock();
      const bool go_on = take(due.key(), std::move(due.mapped()));
      due = {};
      lock.lock();
      ++taken;
      stopped = stopped || !go_on;
      taken_one.notify_all();
    }
    someone_takes = false;
  };

  const auto run = [&] {
    std::unique_lock lock(mutex);
    while (!stopped && next < count) {
      const std::size_t item = next++;
      taken_one.wait(lock, [&] { return stopped || item < taken + window; });
      if (stopped) return;
      lock.unlock();
      Outcome outcome = work(item);
      lock.lock();
      waiting.emplace(item, std::move(outcome));
      if (!someone_takes) take_what_is_due(lock);
    }
  };
  // Otherwise the other threads would wait for the item whose work threw.
  const auto guarded = [&] {
    try {
      run();
    } catch (...) {
      const std::lock_guard lock(mutex);
      stopped = true;
      taken_one.notify_all();
      throw;
    }
  };

  on_threads(static_cast<std::size_t>(std::max(threads, 1)), guarded);
}

}  // namespace krok
