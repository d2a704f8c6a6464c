// If these fail, a run that was killed leaves files behind for good, or a run removes what another
// one is just writing.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
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

// Runs `write` in a child that is killed then.
void do_and_be_killed(const std::function<void()>& write) {
  const pid_t child = fork();
  if (child == 0) {
    write();
    kill(getpid(), SIGKILL);
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST_F(TemporaryTest, ThoseOfKilledProgramsAreRemoved) {
  put("out", "old");
  do_and_be_killed([&] { (void)create_temporary(folder_.string()); });
  ASSERT_EQ(count(), 2u);
  remove_temporaries_of_killed(folder_.string());
  EXPECT_EQ(count(), 1u);
  EXPECT_EQ(get(path("out")), "old");
}

// Another process may have the id of one that was killed long ago.
TEST_F(TemporaryTest, ThoseOfKilledProgramsAreRemovedWhoeverHasTheirIdNow) {
  Temporary own = create_temporary(folder_.string());
  ASSERT_GE(own.descriptor, 0);
  close(own.descriptor);
  const std::string name = base_name(own.path);
  const std::string id = "-" + std::to_string(getpid()) + "-";
  const std::size_t after = name.find(id) + id.size();
  put(name.substr(0, after) + "1" + name.substr(name.rfind('-')), "of a process that started once");
  ASSERT_EQ(count(), 2u);
  remove_temporaries_of_killed(folder_.string());
  EXPECT_EQ(listing(), std::vector<std::string>{name});
  unlink(own.path.c_str());
  forget_temporary(own.slot);
}

TEST_F(TemporaryTest, TheFirstFileWrittenToAFolderRemovesThem) {
  do_and_be_killed([&] { (void)create_temporary(folder_.string()); });
  ASSERT_EQ(count(), 1u);
  ASSERT_TRUE(write_file(path("out"), "new"));
  EXPECT_EQ(listing(), std::vector<std::string>{"out"});
}

TEST_F(TemporaryTest, AKilledProgramLeavesNothing) {
  const int unnamed = create_unnamed(folder_.string());
  if (unnamed < 0) GTEST_SKIP() << "skipped: all files have names in this file system";
  close(unnamed);
  put("out", "old");
  for (const std::string name : {"out", "another"}) {
    do_and_be_killed([&] {
      auto file = OutputFile::create(path(name));
      (void)(file && file->write("new") && file->seal());
      kill(getpid(), SIGKILL);
    });
  }
  EXPECT_EQ(listing(), std::vector<std::string>{"out"});
  EXPECT_EQ(get(path("out")), "old");
}

TEST_F(TemporaryTest, ThoseInUseAndOthersStay) {
  put("out", "old");
  const Temporary own = create_temporary(folder_.string());
  ASSERT_GE(own.descriptor, 0);
  close(own.descriptor);
  put(".krok-elsewhere-1-0", "");
  remove_temporaries_of_killed(folder_.string());
  EXPECT_EQ(count(), 3u);
  unlink(own.path.c_str());
  forget_temporary(own.slot);
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
          for (;;) {
            const Temporary one = create_temporary(folder_.string());
            close(one.descriptor);
            unlink(one.path.c_str());
            forget_temporary(one.slot);
          }
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
