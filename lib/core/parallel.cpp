#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace krok {

int thread_count(int jobs) {
  if (jobs > 0) return jobs;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(std::size_t count, std::size_t grain, int jobs,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t ranges = (count + grain - 1) / grain;
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::size_t failed_range = ranges;
  std::mutex failure_mutex;

  const auto work = [&] {
    for (;;) {
      const std::size_t range = next.fetch_add(1);
      if (range >= ranges) return;
      const std::size_t begin = range * grain;
      try {
        body(begin, std::min(begin + grain, count));
      } catch (...) {
        next.store(ranges);
        const std::lock_guard lock(failure_mutex);
        // Ranges are begun in order, so that the first one that throws is always among those run.
        if (range < failed_range) {
          failed_range = range;
          failure = std::current_exception();
        }
        return;
      }
    }
  };

  const std::size_t threads = std::min(static_cast<std::size_t>(thread_count(jobs)), ranges);
  {
    std::vector<std::jthread> helpers;
    for (std::size_t i = 1; i < threads; ++i) helpers.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace krok
