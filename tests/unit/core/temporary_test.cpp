// If these fail, a run that was killed leaves files behind for good, or a run removes what another
// one is just writing.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <thread>
#include <vector>

#include "core/file.h"
#include "core/temporary_files_internal.h"
#include "support/folder_test.h"

namespace krok {
namespace {

class TemporaryTest : public test::FolderTest {
 protected:
  std::size_t count() const { return listing().size(); }
};

// In a child that is killed while it writes "out".
void write_and_be_killed(const std::string& path) {
  const pid_t child = fork();
  if (child == 0) {
    auto file = OutputFile::create(path);
    kill(getpid(), SIGKILL);
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST_F(TemporaryTest, ThoseOfKilledProgramsAreRemoved) {
  put("out", "old");
  write_and_be_killed(path("out"));
  ASSERT_EQ(count(), 2u);
  remove_temporaries_of_killed(folder_.string());
  EXPECT_EQ(count(), 1u);
  EXPECT_EQ(get(path("out")), "old");
}

TEST_F(TemporaryTest, AKilledProgramThatReplacesNothingLeavesNothing) {
  const int unnamed = create_unnamed(folder_.string());
  if (unnamed < 0) GTEST_SKIP() << "skipped: all files have names in this file system";
  close(unnamed);
  write_and_be_killed(path("out"));
  EXPECT_EQ(count(), 0u);
}

TEST_F(TemporaryTest, ThoseInUseAndOthersStay) {
  put("out", "old");
  auto file = OutputFile::create((folder_ / "out").string());
  ASSERT_TRUE(file);
  fclose(fopen((folder_ / ".krok-elsewhere-1-0").c_str(), "w"));
  remove_temporaries_of_killed(folder_.string());
  EXPECT_EQ(count(), 3u);
  EXPECT_TRUE(file->commit());
  remove_temporaries_of_killed((folder_ / "no such folder").string());
}

// Threads that make one file after the other while the signal comes.
TEST_F(TemporaryTest, ASignalAmongManyThreadsLeavesNone) {
  put("out", "old");
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
    ASSERT_EQ(count(), 1u) << "round " << round;
  }
}

// More than one table of names holds.
TEST_F(TemporaryTest, ASignalRemovesHoweverManyThereAre) {
  const pid_t child = fork();
  if (child == 0) {
    remove_temporaries_on_signals();
    std::vector<OutputFile> files;  // most of them have names
    for (int i = 0; i < 1500; ++i) {
      auto file = OutputFile::create(path("out" + std::to_string(i)), {.stored_later = true});
      if (!file || !file->write("text") || !file->seal()) _exit(1);
      files.push_back(std::move(*file));
    }
    kill(getpid(), SIGTERM);
    for (;;) pause();
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << status;
  EXPECT_EQ(count(), 0u);
}

// As `ulimit -f` has it.
TEST_F(TemporaryTest, AFileThatGrowsTooLargeIsAnError) {
  put("out", "old");
  const pid_t child = fork();
  if (child == 0) {
    remove_temporaries_on_signals();
    rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const Status status = write_file(path("out"), std::string(1 << 20, 'n'));
    _exit(!status && status.error().code == "file-unwritable" ? 7 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
  EXPECT_EQ(get(path("out")), "old");
  EXPECT_EQ(count(), 1u);
}

}  // namespace
}  // namespace krok
