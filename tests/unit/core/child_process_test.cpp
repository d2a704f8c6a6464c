// If these fail, a crash, a hang or a hunger for memory of a library that reads strangers' files
// takes the program with it, or leaves processes and descriptors behind.

#include "core/child_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <thread>

#include "support/this_build.h"

namespace krok {
namespace {

using test::sanitized;

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::ptrdiff_t open_descriptors() {
  const std::filesystem::directory_iterator folder("/proc/self/fd");
  return std::distance(begin(folder), end(folder));
}

class ChildProcess : public testing::Test {
 protected:
  void SetUp() override { descriptors_ = open_descriptors(); }
  void TearDown() override {
    EXPECT_EQ(open_descriptors(), descriptors_) << "a descriptor was left behind";
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
  }
  std::ptrdiff_t descriptors_ = 0;
};

TEST_F(ChildProcess, BytesComeBackAndNothingElseChanges) {
  int here = 1;
  const auto report = run_in_child([&] {
    here = 2;
    return bytes_of("done");
  });
  EXPECT_EQ(report.end, ChildEnd::returned);
  EXPECT_EQ(text_of(report.bytes), "done");
  EXPECT_EQ(here, 1);
}

TEST_F(ChildProcess, NoBytesAndManyBytesComeBackWhole) {
  EXPECT_EQ(run_in_child([] { return Bytes(); }).end, ChildEnd::returned);
  Bytes many(5'000'001);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = static_cast<std::byte>(i * 7 >> 3);
  const auto report = run_in_child([&] { return many; });
  EXPECT_EQ(report.end, ChildEnd::returned);
  EXPECT_TRUE(report.bytes == many);
}

TEST_F(ChildProcess, ExceptionsBecomeText) {
  const auto report = run_in_child([]() -> Bytes { throw std::runtime_error("no such thing"); });
  EXPECT_EQ(report.end, ChildEnd::threw);
  EXPECT_EQ(report.what, "no such thing");
  const auto odd = run_in_child([]() -> Bytes { throw 7; });
  EXPECT_EQ(odd.end, ChildEnd::threw);
  EXPECT_FALSE(odd.what.empty());
}

TEST_F(ChildProcess, CrashesAreToldByTheirSignal) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGKILL}) {
    const auto report = run_in_child([&]() -> Bytes {
      raise(signal);
      return {};
    });
    EXPECT_EQ(report.end, ChildEnd::crashed);
    EXPECT_EQ(report.signal, signal);
    EXPECT_EQ(report.what, signal_text(signal));
  }
  EXPECT_EQ(signal_text(SIGSEGV), "segmentation fault");
  EXPECT_EQ(signal_text(50), "signal 50");
}

TEST_F(ChildProcess, EndingTheProcessIsACrash) {
  const auto report = run_in_child([]() -> Bytes { _exit(3); });
  EXPECT_EQ(report.end, ChildEnd::crashed);
  EXPECT_EQ(report.signal, 0);
  EXPECT_NE(report.what.find("code 3"), std::string::npos);
}

TEST_F(ChildProcess, EndlessRecursionIsACrash) {
  // Each level's array is used after the deeper ones, so that none can be left out.
  struct Deep {
    static int go(int level) {
      volatile char room[4096];
      room[level % 4096] = 1;
      return level < 0 ? 0 : go(level + 1) + room[level % 4096];
    }
  };
  const auto report = run_in_child([]() -> Bytes { return Bytes(Deep::go(1) > 0 ? 1u : 2u); });
  EXPECT_EQ(report.end, ChildEnd::crashed);
}

TEST_F(ChildProcess, AHangIsStoppedInTime) {
  ChildLimits limits;
  limits.seconds = 0.2;
  const auto start = std::chrono::steady_clock::now();
  const auto asleep = run_in_child(
      []() -> Bytes {
        for (;;) pause();
      },
      limits);
  EXPECT_EQ(asleep.end, ChildEnd::out_of_time);
  EXPECT_EQ(asleep.signal, 0) << asleep.what;
  const auto busy = run_in_child(
      []() -> Bytes {
        for (volatile int i = 0;;) i = i + 1;
      },
      limits);
  EXPECT_EQ(busy.end, ChildEnd::out_of_time);
  // Unless the machine is so busy that the child gets less than a tenth of the time.
  if (std::stod(busy.what) < 1) {
    EXPECT_EQ(busy.signal, SIGPROF) << busy.what;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

// A child that gets little of a busy machine, and so takes longer than its CPU time allows.
TEST_F(ChildProcess, TimeInWhichItDoesNotRunHardlyCounts) {
  ChildLimits limits;
  limits.seconds = 0.2;
  const auto slow = run_in_child(
      [] {
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        return Bytes(1, std::byte{7});
      },
      limits);
  EXPECT_EQ(slow.end, ChildEnd::returned) << slow.what;
}

TEST_F(ChildProcess, MemoryIsBounded) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers reserve more address space than any limit";
  ChildLimits limits;
  limits.memory_bytes = 64 << 20;
  const auto eat = [](std::size_t size) {
    return [size] {
      const Bytes memory(size, std::byte{1});
      return Bytes(1, memory[size / 2]);
    };
  };
  EXPECT_EQ(run_in_child(eat(32 << 20), limits).end, ChildEnd::returned);
  EXPECT_EQ(run_in_child(eat(256 << 20), limits).end, ChildEnd::out_of_memory);
  // A library that catches the exception and goes on changes nothing.
  const auto stubborn = run_in_child(
      [&]() -> Bytes {
        try {
          return eat(256 << 20)();
        } catch (...) {
          return bytes_of("went on");
        }
      },
      limits);
  EXPECT_EQ(stubborn.end, ChildEnd::out_of_memory);
  // What the caller has counts for nothing.
  const Bytes of_the_caller(256 << 20, std::byte{1});
  EXPECT_EQ(run_in_child(eat(32 << 20), limits).end, ChildEnd::returned);
}

TEST_F(ChildProcess, ResultsAreBounded) {
  ChildLimits limits;
  limits.result_bytes = 1000;
  EXPECT_EQ(run_in_child([] { return Bytes(1000); }, limits).end, ChildEnd::returned);
  EXPECT_EQ(run_in_child([] { return Bytes(1001); }, limits).end, ChildEnd::result_too_large);
  EXPECT_EQ(run_in_child([] { return Bytes(5'000'000); }, limits).end, ChildEnd::result_too_large);
}

TEST_F(ChildProcess, NothingCanBeOpenedAndNothingIsPrinted) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const auto report = run_in_child([&] {
    std::string found;
    // Sanitizers must be able to.
    if (!sanitized() && ::open("/dev/null", O_RDONLY) >= 0) found += "file ";
    if (!sanitized() && socket(AF_INET, SOCK_STREAM, 0) >= 0) found += "socket ";
    if (::write(ends[1], "x", 1) == 1) found += "pipe ";
    char byte = 0;
    if (::read(STDIN_FILENO, &byte, 1) != 0) found += "input ";
    if (::write(STDERR_FILENO, "x", 1) != 1) found += "error ";
    return bytes_of(found);
  });
  EXPECT_EQ(report.end, ChildEnd::returned);
  EXPECT_EQ(text_of(report.bytes), "");
  ::close(ends[0]);
  ::close(ends[1]);

  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  (void)run_in_child([] {
    std::fputs("loud", stdout);
    std::fflush(stdout);
    std::fputs("loud", stderr);
    return Bytes();
  });
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

std::atomic<int> handled{0};

TEST_F(ChildProcess, TheCallersSignalHandlersAreNotTheChilds) {
  struct sigaction mine {
  }, before{};
  mine.sa_handler = [](int) { handled = 1; };
  sigaction(SIGTERM, &mine, &before);
  const auto report = run_in_child([]() -> Bytes {
    raise(SIGTERM);
    return {};
  });
  EXPECT_EQ(report.end, ChildEnd::crashed);
  EXPECT_EQ(report.signal, SIGTERM);
  raise(SIGTERM);
  EXPECT_EQ(handled.load(), 1);  // and they are still the caller's
  sigaction(SIGTERM, &before, nullptr);
}

TEST_F(ChildProcess, WorksWhereChildrenAreIgnored) {
  struct sigaction ignore {
  }, before{};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGCHLD, &ignore, &before);
  EXPECT_EQ(run_in_child([] { return bytes_of("a"); }).end, ChildEnd::returned);
  EXPECT_EQ(run_in_child([]() -> Bytes { std::abort(); }).end, ChildEnd::crashed);
  sigaction(SIGCHLD, &before, nullptr);
}

TEST_F(ChildProcess, ManyThreadsAtOnce) {
  // Under a sanitizer a lock of its allocator may be taken while another thread forks.
  const int kThreads = sanitized() ? 2 : 8;
  std::atomic<int> right{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&right, t] {
      for (int i = 0; i < 10; ++i) {
        const std::string text(static_cast<std::size_t>(1000 * t + i), 'x');
        const auto report = run_in_child([&]() -> Bytes {
          if (i % 5 == 4) std::abort();
          return bytes_of(text);
        });
        if (i % 5 == 4 ? report.signal == SIGABRT : text_of(report.bytes) == text) ++right;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right.load(), 10 * kThreads);
}

}  // namespace
}  // namespace krok
