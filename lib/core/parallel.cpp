#include "core/parallel.h"

#include <pthread.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace krok {

namespace {

// Spin-waiting for another thread that is about to finish.

// How long to spin before sleeping: loops often follow each other closely, and waking a core takes
// tens of microseconds.
constexpr std::chrono::microseconds kAwake{200};

void rest_a_moment() {
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
  using SteadyClock = std::chrono::steady_clock;
  constexpr int kLooks = 32;  // checks between two clock reads
  const auto end = SteadyClock::now() + kAwake;
  do {
    for (int i = 0; i < kLooks; ++i) {
      if (condition()) return;
      rest_a_moment();
    }
    std::this_thread::yield();
  } while (SteadyClock::now() < end);
}

// Whether this thread is inside the work of a call.
thread_local bool within_work = false;

// A call in progress, on the caller's stack. A helper's last access is to decrement `running`.
struct Call {
  const std::function<void()>& work;
  std::size_t wanted;                   // helpers that may still start
  std::atomic<std::size_t> running{0};  // helpers that have started and are not done
  bool caller_sleeps = false;
  Call* next = nullptr;  // in the list of calls that want helpers
};

class Threads {
 public:
  void call(std::size_t helpers, const std::function<void()>& work) {
    const bool outermost = !within_work;
    Call call{work, helpers};
    std::unique_lock lock(mutex_);
    if (outermost) asked_ += helpers;
    make_threads(helpers, outermost ? asked_ : std::max(asked_, cores_ - 1));
    open(call);
    const std::size_t woken = std::min(wanted_, asleep_);
    lock.unlock();
    for (std::size_t i = 0; i < woken; ++i) call_made_.notify_one();

    within_work = true;
    work();
    within_work = !outermost;

    lock.lock();
    if (call.wanted > 0) close(call);
    if (outermost) asked_ -= helpers;
    lock.unlock();
    wait_for(call);
  }

  // Ends all threads, unless work is in progress, as when a program exits within it. Returns
  // whether they have ended.
  bool end() {
    {
      const std::lock_guard lock(mutex_);
      if (asked_ > 0) return false;
      ending_ = true;
    }
    call_made_.notify_all();
    for (std::thread& thread : threads_) thread.join();
    return true;
  }

 private:
  void serve() noexcept {
    within_work = true;
    std::unique_lock lock(mutex_);
    for (;;) {
      if (first_open_ == nullptr && threads_.size() < cores_) {
        lock.unlock();
        stay_awake_until([&] { return wanted_now_.load(std::memory_order_relaxed) > 0; });
        lock.lock();
      }
      ++asleep_;
      call_made_.wait(lock, [&] { return ending_ || first_open_ != nullptr; });
      --asleep_;
      if (ending_) return;
      help(*first_open_, lock);
    }
  }

  void help(Call& call, std::unique_lock<std::mutex>& lock) {
    call.running.fetch_add(1, std::memory_order_relaxed);
    set_wanted(wanted_ - 1);
    if (--call.wanted == 0) close(call);
    --free_;
    lock.unlock();
    call.work();
    lock.lock();
    ++free_;
    if (call.wanted > 0) close(call);
    const bool caller_sleeps = call.caller_sleeps;
    const bool last = call.running.fetch_sub(1, std::memory_order_release) == 1;
    if (last && caller_sleeps) work_done_.notify_all();
  }

  void wait_for(Call& call) {
    const auto done = [&] { return call.running.load(std::memory_order_acquire) == 0; };
    stay_awake_until(done);
    if (done()) return;
    std::unique_lock lock(mutex_);
    call.caller_sleeps = true;
    work_done_.wait(lock, done);
  }

  // Creates the threads missing for `helpers` more, up to `most` in all. If the system provides
  // fewer, the work runs on those.
  void make_threads(std::size_t helpers, std::size_t most) {
    try {
      while (free_ < wanted_ + helpers && threads_.size() < most) {
        threads_.emplace_back([this] { serve(); });
        ++free_;
      }
    } catch (const std::system_error&) {  // a limit of the system
    } catch (const std::bad_alloc&) {
    }
  }

  // Lets helpers start, after those of older calls.
  void open(Call& call) {
    Call** last = &first_open_;
    while (*last != nullptr) last = &(*last)->next;
    *last = &call;
    set_wanted(wanted_ + call.wanted);
  }

  // Lets no further helper start.
  void close(Call& call) {
    Call** place = &first_open_;
    while (*place != &call) place = &(*place)->next;
    *place = call.next;
    set_wanted(wanted_ - call.wanted);
    call.wanted = 0;
  }

  void set_wanted(std::size_t wanted) {
    wanted_ = wanted;
    wanted_now_.store(wanted, std::memory_order_relaxed);
  }

  const std::size_t cores_ = std::max(1u, std::thread::hardware_concurrency());
  std::mutex mutex_;
  std::condition_variable call_made_, work_done_;
  std::vector<std::thread> threads_;
  Call* first_open_ = nullptr;              // the oldest that wants helpers
  std::size_t wanted_ = 0;                  // helpers wanted by all open calls
  std::atomic<std::size_t> wanted_now_{0};  // same, readable without the mutex
  std::size_t asked_ = 0;                   // helpers of all outermost calls in progress
  std::size_t free_ = 0;                    // idle threads
  std::size_t asleep_ = 0;                  // idle threads that must be woken
  bool ending_ = false;
};

std::atomic<Threads*> kept{nullptr};
std::atomic<bool> ended{false};
Threads* of_parent = nullptr;

// Null if out of memory, and at program exit.
Threads* kept_threads() {
  if (Threads* threads = kept.load(std::memory_order_acquire)) return threads;
  if (ended.load()) return nullptr;
  Threads* made = new (std::nothrow) Threads;
  Threads* other = nullptr;
  if (made == nullptr || kept.compare_exchange_strong(other, made)) return made;
  delete made;  // another thread was first
  return other;
}

// A forked child does not have the threads, and their shared state may be inconsistent.
const int forks_reported =
    pthread_atfork(nullptr, nullptr, [] { of_parent = kept.exchange(nullptr); });

struct ProgramEnd {
  ~ProgramEnd() {
    ended.store(true);
    Threads* threads = kept.load();
    if (threads == nullptr || !threads->end()) return;
    kept.store(nullptr);
    delete threads;
  }
} program_end;

// Calls `work`, which must not throw, on this thread and concurrently on up to `helpers` others,
// and returns when all calls are done. Once the first call returns, no further one starts. Can be
// called on several threads and from within `work`: nobody waits for a thread that has not started,
// so there is no deadlock.
//
// The pool never has more threads than all outermost calls in progress request together, or than
// the machine has cores if nested calls request more. A child of fork() has none of them and
// creates its own; it must not return into a call that its parent was in.
void call_on_kept_threads(std::size_t helpers, const std::function<void()>& work) {
  Threads* threads = helpers == 0 ? nullptr : kept_threads();
  if (threads == nullptr) return work();
  threads->call(helpers, work);
}

}  // namespace

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
