// If these fail, a run that was killed leaves files behind for good, or a run removes what another
// one is just writing.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <thread>
#include <vector>

#include "core/file.h"

namespace krok {
namespace {

namespace fs = std::filesystem;

class TemporaryTest : public testing::Test {
 protected:
  TemporaryTest() {
    std::string name = (fs::temp_directory_path() / "krok-temporary-test-XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  ~TemporaryTest() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  std::size_t count() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

TEST_F(TemporaryTest, ThoseOfKilledProgramsAreRemoved) {
  const pid_t child = fork();
  if (child == 0) {
    auto file = OutputFile::create((folder_ / "out").string());
    kill(getpid(), SIGKILL);
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(count(), 1u);
  remove_temporaries_of_killed(folder_.string());
  EXPECT_EQ(count(), 0u);
}

TEST_F(TemporaryTest, ThoseInUseAndOthersStay) {
  auto file = OutputFile::create((folder_ / "out").string());
  ASSERT_TRUE(file);
  fclose(fopen((folder_ / ".krok-elsewhere-1-0").c_str(), "w"));
  remove_temporaries_of_killed(folder_.string());
  EXPECT_EQ(count(), 2u);
  EXPECT_TRUE(file->commit());
  remove_temporaries_of_killed((folder_ / "no such folder").string());
}

// Threads that make one file after the other while the signal comes.
TEST_F(TemporaryTest, ASignalAmongManyThreadsLeavesNone) {
  for (int round = 0; round < 20; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      remove_temporaries_on_signals();
      std::vector<std::thread> threads;
      for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
          for (;;) auto file = OutputFile::create((folder_ / "out").string());
        });
      }
      usleep(3000);
      kill(getpid(), SIGTERM);
      for (std::thread& thread : threads) thread.join();
      _exit(1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    ASSERT_EQ(count(), 0u) << "round " << round;
  }
}

}  // namespace
}  // namespace krok
