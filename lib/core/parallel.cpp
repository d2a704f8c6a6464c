#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/kept_threads_internal.h"
#include "core/stay_awake_internal.h"

namespace krok {

int thread_count(int jobs) {
  if (jobs > 0) return jobs;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void on_threads(std::size_t threads, const std::function<void()>& work) {
  if (threads <= 1) return work();
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto guarded = [&]() noexcept {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  call_on_kept_threads(threads - 1, guarded);
  if (failure) std::rethrow_exception(failure);
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
        // Ranges are started in order, so the first one that throws is always among those run.
        if (range < failed_range) {
          failed_range = range;
          failure = std::current_exception();
        }
        return;
      }
    }
  };

  const std::size_t threads = std::min(static_cast<std::size_t>(thread_count(jobs)), ranges);
  on_threads(threads, work);
  if (failure) std::rethrow_exception(failure);
}

std::size_t slots_for(int jobs) {
  const auto threads = static_cast<std::size_t>(thread_count(jobs));
  return threads == 1 ? 1 : 2 * threads;
}

namespace {

// Items are started in order and at most one per slot, so that each uses the slot i % slots.
class InOrder {
 public:
  using Work = std::function<Status(std::size_t, std::size_t)>;
  InOrder(std::size_t count, std::size_t slots, const Work& make, const Work& take)
      : count_(count), slots_(slots), make_(make), take_(take), made_(slots) {}

  void work() noexcept {
    std::unique_lock lock(mutex_);
    for (;;) {
      wait_for_a_slot(lock);
      if (next_ >= end_) return;
      const std::size_t item = next_++;
      lock.unlock();
      Outcome outcome = run(make_, item);
      lock.lock();
      made_[item % slots_] = std::move(outcome);
      if (!someone_takes_) take_what_is_made(lock);
    }
  }

  Status result() {
    if (thrown_) std::rethrow_exception(thrown_);
    return std::move(failure_);
  }

 private:
  struct Outcome {
    bool there = false;
    Status status;
    std::exception_ptr thrown;
    bool good() const { return status.ok() && !thrown; }
  };

  Outcome run(const Work& work, std::size_t item) {
    Outcome outcome;
    outcome.there = true;
    try {
      outcome.status = work(item, item % slots_);
    } catch (...) {
      outcome.thrown = std::current_exception();
    }
    return outcome;
  }

  void wait_for_a_slot(std::unique_lock<std::mutex>& lock) {
    const auto free = [&] { return next_ >= end_ || next_ < taken_ + slots_; };
    if (!free()) {
      const std::size_t seen = freed_.load(std::memory_order_relaxed);
      lock.unlock();
      stay_awake_until([&] { return freed_.load(std::memory_order_relaxed) != seen; });
      lock.lock();
    }
    slot_is_free_.wait(lock, free);
  }

  // The thread that makes the next item due takes it, and all finished items after it.
  void take_what_is_made(std::unique_lock<std::mutex>& lock) {
    someone_takes_ = true;
    while (taken_ < end_ && made_[taken_ % slots_].there) {
      Outcome outcome = std::move(made_[taken_ % slots_]);
      made_[taken_ % slots_] = {};
      lock.unlock();
      if (outcome.good()) outcome = run(take_, taken_);
      lock.lock();
      if (!outcome.good()) {
        failure_ = std::move(outcome.status);
        thrown_ = outcome.thrown;
        end_ = 0;
      }
      ++taken_;
      freed_.fetch_add(1, std::memory_order_relaxed);
      slot_is_free_.notify_all();
    }
    someone_takes_ = false;
  }

  const std::size_t count_, slots_;
  const Work &make_, &take_;
  std::mutex mutex_;
  std::condition_variable slot_is_free_;
  std::size_t end_ = count_;  // where to stop; 0 after a failure
  std::size_t next_ = 0;      // the first item not started
  std::size_t taken_ = 0;     // the first item not taken
  bool someone_takes_ = false;
  std::atomic<std::size_t> freed_{0};  // slots freed so far, readable without the mutex
  std::vector<Outcome> made_;          // [slots]
  Status failure_;
  std::exception_ptr thrown_;
};

}  // namespace

Status make_in_order(std::size_t count, int jobs,
                     const std::function<Status(std::size_t, std::size_t)>& make,
                     const std::function<Status(std::size_t, std::size_t)>& take) {
  const std::size_t slots = slots_for(jobs);
  InOrder order(count, slots, make, take);
  const std::size_t threads = std::min(static_cast<std::size_t>(thread_count(jobs)), count);
  on_threads(threads, [&] { order.work(); });
  return order.result();
}

}  // namespace krok
