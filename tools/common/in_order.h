#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace krok {

// Does work(i) for i from 0 to count - 1 on up to `threads` threads, and gives each outcome to
// take(i, outcome) in the order of i, one at a time, on any of the threads. Work is begun in order,
// at most `window` items ahead of the first one not taken, so that few outcomes wait. Once take
// gives false, no work is begun and nothing is taken any more; what was begun is finished. Neither
// may throw.
template <typename Outcome>
void in_order(std::size_t count, int threads, std::size_t window,
              const std::function<Outcome(std::size_t)>& work,
              const std::function<bool(std::size_t, Outcome)>& take) {
  std::mutex mutex;
  std::condition_variable taken_one;
  std::size_t next = 0, taken = 0;
  bool stopped = false;
  std::map<std::size_t, Outcome> waiting;

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
      while (!stopped && !waiting.empty() && waiting.begin()->first == taken) {
        Outcome first = std::move(waiting.begin()->second);
        waiting.erase(waiting.begin());
        stopped = !take(taken++, std::move(first));
      }
      taken_one.notify_all();
    }
  };

  std::vector<std::jthread> helpers;
  for (int i = 1; i < threads; ++i) helpers.emplace_back(run);
  run();
}

}  // namespace krok
