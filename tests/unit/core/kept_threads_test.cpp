// If these fail, each loop pays for new threads again, loops within loops wait for each other
// forever or make threads without bound, or a child process or the end of a program hangs.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <latch>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/parallel.h"
#include "support/this_build.h"

namespace krok {
namespace {

// ThreadSanitizer, with which the tests, too, are compiled.
#if defined(__SANITIZE_THREAD__)
constexpr bool kWatchesThreads = true;
#else
constexpr bool kWatchesThreads = false;
#endif

// The sanitizers' own allocators, unlike the system's, are not made ready for a fork: a child of a
// process whose other threads allocate at that moment finds a lock that nobody will open.
const bool kForksAmidThreads = !test::sanitized();

// Of this process, sleeping ones too.
std::size_t threads_alive() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

std::size_t cores() {
  return std::max(1u, std::thread::hardware_concurrency());
}

// Runs `work` in a child process; whether that ended well, within ten seconds.
bool ends_well(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(10);
    work();
    _exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// All threads wait for each other, so that each of them must be one of its own.
std::set<std::thread::id> ids_of(int threads) {
  std::mutex mutex;
  std::set<std::thread::id> ids;
  std::latch all(threads);
  on_threads(static_cast<std::size_t>(threads), [&] {
    {
      const std::lock_guard lock(mutex);
      ids.insert(std::this_thread::get_id());
    }
    all.arrive_and_wait();
  });
  return ids;
}

TEST(KeptThreads, AreTheSameInEachLoop) {
  std::set<std::thread::id> all = ids_of(4);
  EXPECT_EQ(all.size(), 4u);
  const std::size_t alive = threads_alive();
  for (int i = 0; i < 50; ++i) all.merge(ids_of(4));
  EXPECT_LE(all.size(), alive);
  EXPECT_EQ(threads_alive(), alive);
}

TEST(KeptThreads, AreWokenAfterALongSleep) {
  (void)ids_of(3);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(ids_of(3).size(), 3u);
}

// A loop that is done soon is not held up by threads that have not begun.
TEST(KeptThreads, AreNotWaitedForBeforeTheyBegin) {
  std::latch others_begun(3), caller_done(1);
  std::atomic<int> calls{0};
  std::thread busy([&] {
    on_threads(3, [&] {
      others_begun.arrive_and_wait();
      caller_done.wait();
    });
  });
  others_begun.wait();
  std::vector<int> done(100);
  parallel_for(100, 1, 2, [&](std::size_t i, std::size_t) {
    ++calls;
    done[i] = 1;
  });
  EXPECT_EQ(calls, 100);
  EXPECT_EQ(std::count(done.begin(), done.end(), 1), 100);
  caller_done.count_down();
  busy.join();
}

TEST(KeptThreads, LoopsWithinLoopsAreDoneWithFewThreads) {
  EXPECT_TRUE(ends_well([] {
    if (kWatchesThreads) return;  // which allows a child no threads of its own
    std::atomic<std::size_t> most{0};
    std::vector<std::atomic<int>> visits(5 * 6 * 7);
    parallel_for(5, 1, 3, [&](std::size_t a, std::size_t) {
      parallel_for(6, 1, 50, [&](std::size_t b, std::size_t) {
        parallel_for(7, 1, 50, [&](std::size_t c, std::size_t) { ++visits[(a * 6 + b) * 7 + c]; });
        std::size_t now = threads_alive(), before = most;
        while (before < now && !most.compare_exchange_weak(before, now)) {
        }
      });
    });
    for (const auto& visit : visits) EXPECT_EQ(visit.load(), 1);
    EXPECT_LE(most, std::max<std::size_t>(3, cores()));
  }));
}

// The outer loop has one range alone, so that the inner one may have all threads.
TEST(KeptThreads, ALoopWithinOneThatNeedsNoneHasThreads) {
  std::size_t inner = 0;
  parallel_for(1, 1, 4, [&](std::size_t, std::size_t) { inner = ids_of(4).size(); });
  EXPECT_EQ(inner, 4u);
}

TEST(KeptThreads, WhatAnInnerLoopThrowsReachesTheOuterOne) {
  for (int round = 0; round < 20; ++round) {
    std::string message;
    try {
      parallel_for(8, 1, 4, [&](std::size_t a, std::size_t) {
        parallel_for(8, 1, 4, [&](std::size_t b, std::size_t) {
          if (a >= 2 && b >= 5) throw std::runtime_error(std::to_string(10 * a + b));
        });
      });
    } catch (const std::runtime_error& error) {
      message = error.what();
    }
    EXPECT_EQ(message, "25");
  }
}

TEST(KeptThreads, ServeCallersOnSeveralThreads) {
  std::vector<std::thread> callers;
  std::atomic<long> sum{0};
  for (int caller = 0; caller < 4; ++caller) {
    callers.emplace_back([&] {
      for (int round = 0; round < 200; ++round) {
        parallel_for(64, 1, 3, [&](std::size_t i, std::size_t) { sum += static_cast<long>(i); });
        const Status status = make_in_order(
            20, 3, [](std::size_t, std::size_t) { return Status(); },
            [&](std::size_t, std::size_t) {
              ++sum;
              return Status();
            });
        EXPECT_TRUE(status);
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(sum, 4 * 200 * (63 * 64 / 2 + 20));
}

// The parent's threads are busy, so that what they share is in the middle of something.
TEST(KeptThreads, AChildMakesItsOwn) {
  if (!kForksAmidThreads) GTEST_SKIP() << "skipped: the sanitizer's allocator may stay locked";
  (void)ids_of(4);
  std::atomic<bool> enough{false};
  std::thread caller([&] {
    while (!enough) parallel_for(16, 1, 4, [](std::size_t, std::size_t) {});
  });
  for (int i = 0; i < 20; ++i) {
    // Without a sanitizer's search for leaks, which would find what the parent's threads hold.
    EXPECT_TRUE(ends_well([] { _exit(ids_of(3).size() == 3 ? 0 : 1); }));
  }
  enough = true;
  caller.join();
}

TEST(KeptThreads, AChildMadeWithinALoopCanHaveLoops) {
  if (!kForksAmidThreads) GTEST_SKIP() << "skipped: the sanitizer's allocator may stay locked";
  std::atomic<int> well{0};
  parallel_for(4, 1, 2, [&](std::size_t, std::size_t) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(10);
      std::atomic<int> items{0};
      parallel_for(100, 1, 2, [&](std::size_t, std::size_t) { ++items; });
      _exit(items == 100 ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) ++well;
  });
  EXPECT_EQ(well, 4);
}

// Sleeping threads do not keep a program from ending, nor do those that are at work. Each ends in a
// process of its own: a forked child would also end what other libraries know of threads that it
// does not have.
TEST(KeptThreads, AProgramEndsWithThem) {
  if (kWatchesThreads) GTEST_SKIP() << "skipped: the sanitizer allows a child no threads";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto sleeping = [] {
    alarm(10);
    (void)ids_of(4);
    std::exit(0);
  };
  EXPECT_EXIT(sleeping(), testing::ExitedWithCode(0), "");
  const auto at_work = [] {
    alarm(10);
    std::latch both(2);
    on_threads(2, [&, caller = std::this_thread::get_id()] {
      both.arrive_and_wait();
      if (std::this_thread::get_id() != caller) std::exit(0);
      std::this_thread::sleep_for(std::chrono::minutes(1));
    });
  };
  EXPECT_EXIT(at_work(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace krok
