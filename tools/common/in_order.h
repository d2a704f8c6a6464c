#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>

#include "core/parallel.h"

namespace krok {

// Does work(i) for i from 0 to count - 1 on up to `threads` threads, and gives each outcome to
// take(i, outcome) in the order of i, one at a time, on any of the threads. Work is begun in order,
// at most `window` items ahead of the first one not taken, so that few outcomes wait. Once take
// gives false, no work is begun and nothing is taken any more; what was begun is finished. The same
// after one of them throws, and the exception is thrown on.
template <typename Outcome>
void in_order(std::size_t count, int threads, std::size_t window,
              const std::function<Outcome(std::size_t)>& work,
              const std::function<bool(std::size_t, Outcome)>& take) {
  std::mutex mutex;
  std::condition_variable taken_one;
  std::size_t next = 0, taken = 0;
  bool stopped = false, someone_takes = false;
  std::map<std::size_t, Outcome> waiting;

  // Meanwhile others go on with their work, and leave what they have done to whoever takes.
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
  // The others would wait for the item of one that throws.
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
