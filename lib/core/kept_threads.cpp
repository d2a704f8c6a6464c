#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "core/kept_threads_internal.h"
#include "core/stay_awake_internal.h"

namespace krok {

namespace {

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

}  // namespace

void call_on_kept_threads(std::size_t helpers, const std::function<void()>& work) {
  Threads* threads = helpers == 0 ? nullptr : kept_threads();
  if (threads == nullptr) return work();
  threads->call(helpers, work);
}

}  // namespace krok
