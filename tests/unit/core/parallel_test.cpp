// If these fail, work is skipped or done twice, or results and errors depend on the number of
// threads.
#include "core/parallel.h"
#include "support/this_build.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <latch>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace krok {
namespace {

TEST(ThreadCount, IsAtLeastOne) {
  EXPECT_EQ(thread_count(3), 3);
  EXPECT_GE(thread_count(0), 1);
  EXPECT_GE(thread_count(-5), 1);
}

TEST(ParallelFor, CoversEachItemOnce) {
  for (const std::size_t count : {0, 1, 2, 63, 64, 65, 1000}) {
    for (const std::size_t grain : {0, 1, 7, 64, 5000}) {
      for (const int jobs : {1, 2, 5, 0}) {
        std::vector<std::atomic<int>> visits(count);
        parallel_for(count, grain, jobs, [&](std::size_t begin, std::size_t end) {
          EXPECT_LT(begin, end);
          EXPECT_LE(end - begin, std::max<std::size_t>(grain, 1));
          EXPECT_EQ(begin % std::max<std::size_t>(grain, 1), 0u);
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        for (const auto& visit : visits) EXPECT_EQ(visit.load(), 1);
      }
    }
  }
}

TEST(ParallelFor, OneJobRunsInOrderOnTheCaller) {
  std::vector<std::size_t> begins;
  const auto caller = std::this_thread::get_id();
  parallel_for(10, 3, 1, [&](std::size_t begin, std::size_t) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    begins.push_back(begin);
  });
  EXPECT_EQ(begins, (std::vector<std::size_t>{0, 3, 6, 9}));
}

TEST(ParallelFor, GivesTheSameForAnyNumberOfJobs) {
  const auto run = [](int jobs) {
    std::vector<double> sums(100);
    parallel_for(1000, 10, jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        sums[begin / 10] += std::sin(static_cast<double>(i));
    });
    return sums;
  };
  const auto alone = run(1);
  EXPECT_EQ(run(2), alone);
  EXPECT_EQ(run(7), alone);
}

// The error a user sees must not depend on which thread was quicker.
TEST(ParallelFor, RethrowsTheFirstInOrder) {
  for (int round = 0; round < 20; ++round) {
    for (const int jobs : {1, 2, 4}) {
      std::string message;
      try {
        parallel_for(100, 1, jobs, [](std::size_t begin, std::size_t) {
          if (begin == 3) std::this_thread::sleep_for(std::chrono::milliseconds(2));
          if (begin >= 3) throw std::runtime_error(std::to_string(begin));
        });
      } catch (const std::runtime_error& error) {
        message = error.what();
      }
      EXPECT_EQ(message, "3") << jobs << " jobs";
    }
  }
}

TEST(ParallelFor, SkipsTheRestAfterAnException) {
  std::atomic<int> calls{0};
  EXPECT_THROW(parallel_for(1000, 1, 1,
                            [&](std::size_t, std::size_t) {
                              if (++calls == 5) throw std::runtime_error("stop");
                            }),
               std::runtime_error);
  EXPECT_EQ(calls.load(), 5);
}

TEST(OnThreads, CallsAtMostOnceAThread) {
  for (const std::size_t threads : {0, 1, 2, 5}) {
    std::atomic<std::size_t> calls{0};
    std::mutex mutex;
    std::set<std::thread::id> callers;
    on_threads(threads, [&] {
      ++calls;
      const std::lock_guard lock(mutex);
      EXPECT_TRUE(callers.insert(std::this_thread::get_id()).second);
    });
    EXPECT_TRUE(callers.contains(std::this_thread::get_id()));
    EXPECT_LE(calls, std::max<std::size_t>(threads, 1));
  }
}

TEST(OnThreads, WhatIsThrownIsThrownOnOnceAllAreDone) {
  std::atomic<int> begun{0}, done{0};
  std::latch all(4);
  EXPECT_THROW(on_threads(4,
                          [&] {
                            const bool second = begun++ == 1;
                            all.arrive_and_wait();
                            if (!second) std::this_thread::sleep_for(std::chrono::milliseconds(2));
                            ++done;
                            if (second) throw std::runtime_error("one of them");
                          }),
               std::runtime_error);
  EXPECT_EQ(done, 4);
}

// Of a thousand threads the system gives only a few here, for each takes 8 MB of address space.
TEST(OnThreads, GoesOnWithTheThreadsThatThereAre) {
  if (test::sanitized()) GTEST_SKIP() << "skipped: a sanitizer's memory has no limits";
  const pid_t child = fork();
  if (child == 0) {
    rlimit limit{std::size_t{300} << 20, std::size_t{300} << 20};
    if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(1);
    std::atomic<std::size_t> calls{0}, items{0};
    on_threads(1000, [&] { ++calls; });
    parallel_for(2000, 1, 1000, [&](std::size_t, std::size_t) { ++items; });
    const Status status = make_in_order(
        2000, 1000, [](std::size_t, std::size_t) { return Status(); },
        [&](std::size_t, std::size_t) {
          ++items;
          return Status();
        });
    _exit(calls >= 1 && calls < 1000 && items == 4000 && status ? 7 : 2);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
}

}  // namespace
}  // namespace krok
