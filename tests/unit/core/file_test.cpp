// If these fail, a user's file is lost or left half-written, or a device is replaced by a file.
#include "core/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "core/hash.h"
#include "support/folder_test.h"
#include "support/this_build.h"

namespace krok {
namespace {

using test::sanitized;

namespace fs = std::filesystem;

using FileTest = test::FolderTest;
using Names = std::vector<std::string>;

TEST_F(FileTest, ReadsAWholeFile) {
  put("a", std::string("one\0two", 7));
  const auto file = InputFile::open(path("a"));
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file->text(), std::string_view("one\0two", 7));
  EXPECT_EQ(file->path(), path("a"));
}

TEST_F(FileTest, ReadsAnEmptyFile) {
  put("a", "");
  const auto file = InputFile::open(path("a"));
  ASSERT_TRUE(file.ok());
  EXPECT_TRUE(file->bytes().empty());
}

TEST_F(FileTest, ReadsAPipe) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  std::thread writer([&] { put("pipe", std::string(200000, 'x')); });
  const auto file = InputFile::open(path("pipe"));
  writer.join();
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file->text(), std::string(200000, 'x'));
}

TEST_F(FileTest, SaysWhyAFileCannotBeRead) {
  const auto code = [&](const std::string& name, std::uint64_t limit = 1000) {
    const auto file = InputFile::open(name, limit);
    EXPECT_FALSE(file.ok());
    if (file.ok()) return std::string();
    EXPECT_EQ(file.error().where.file, name);
    return file.error().code;
  };
  put("big", std::string(1001, 'x'));
  put("plain", "x");
  EXPECT_EQ(code(path("missing")), "file-missing");
  EXPECT_EQ(code(path("plain/inside")), "file-missing");
  EXPECT_EQ(code(folder_.string()), "file-directory");
  EXPECT_EQ(code(path("big")), "file-too-large");
  EXPECT_EQ(code("/dev/zero"), "file-too-large");
  EXPECT_EQ(code(""), "file-missing");
}

TEST_F(FileTest, AppearsOnlyOnCommit) {
  auto file = OutputFile::create(path("out"));
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->write("abc").ok());
  EXPECT_FALSE(fs::exists(path("out")));
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(get(path("out")), "abc");
  EXPECT_EQ(listing(), Names{"out"});
}

TEST_F(FileTest, LeavesNothingWithoutCommit) {
  put("out", "old");
  {
    auto file = OutputFile::create(path("out"));
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(file->write(std::string(1 << 20, 'n')).ok());
    EXPECT_EQ(listing(), Names{"out"}) << "a name before it is complete outlives a kill";
  }
  EXPECT_EQ(get(path("out")), "old");
  EXPECT_EQ(listing(), Names{"out"});
}

TEST_F(FileTest, AnAssignedOverFileIsDiscarded) {
  put("first", "old");
  put("second", "old");
  auto first = OutputFile::create(path("first"));
  auto second = OutputFile::create(path("second"));
  ASSERT_TRUE(first.ok() && second.ok() && second->write("new").ok());
  *first = std::move(*second);
  ASSERT_TRUE(first->commit().ok());
  EXPECT_EQ(listing(), (Names{"first", "second"}));
  EXPECT_EQ(get(path("first")), "old");
  EXPECT_EQ(get(path("second")), "new");
}

TEST_F(FileTest, WhatComesMeanwhileIsReplaced) {
  auto file = OutputFile::create(path("out"));
  ASSERT_TRUE(file.ok() && file->write("new").ok());
  put("out", "other");
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(get(path("out")), "new");
  EXPECT_EQ(listing(), Names{"out"});
}

TEST_F(FileTest, WhatComesMeanwhileIsKeptIfAskedFor) {
  auto file = OutputFile::create(path("out"), {.no_clobber = true});
  ASSERT_TRUE(file.ok() && file->write("new").ok());
  put("out", "other");
  const Status status = file->commit();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "file-exists");
  EXPECT_EQ(get(path("out")), "other");
  EXPECT_EQ(listing(), Names{"out"});
}

TEST_F(FileTest, ASealedFileCanBeRead) {
  for (const bool replaces : {false, true}) {
    if (replaces) put("out", "old");
    auto file = OutputFile::create(path("out"));
    ASSERT_TRUE(file.ok() && file->write("new").ok() && file->seal().ok());
    EXPECT_EQ(get(file->written_at()), "new");
    ASSERT_TRUE(file->commit().ok());
    EXPECT_EQ(get(path("out")), "new");
    EXPECT_EQ(listing(), Names{"out"});
  }
}

TEST_F(FileTest, OverwritesWhatIsWritten) {
  auto file = OutputFile::create(path("out"));
  ASSERT_TRUE(file.ok());
  EXPECT_TRUE(file->can_overwrite());
  ASSERT_TRUE(file->write("0123456789").ok());
  ASSERT_TRUE(file->overwrite(2, std::as_bytes(std::span("AB", 2))).ok());
  ASSERT_TRUE(file->write("xyz").ok());
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(get(path("out")), "01AB456789xyz");
}

TEST_F(FileTest, NoClobberRefusesAFileThatExists) {
  put("out", "old");
  const auto file = OutputFile::create(path("out"), {.no_clobber = true});
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().code, "file-exists");
  EXPECT_EQ(get(path("out")), "old");
}

TEST_F(FileTest, NoClobberRefusesAFileThatAppearedMeanwhile) {
  auto file = OutputFile::create(path("out"), {.no_clobber = true});
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->write("new").ok());
  put("out", "other");
  const Status status = file->commit();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "file-exists");
  EXPECT_EQ(get(path("out")), "other");
  EXPECT_EQ(listing(), Names{"out"});
}

TEST_F(FileTest, NoClobberWritesANewFile) {
  ASSERT_TRUE(write_file(path("out"), "new", {.no_clobber = true}).ok());
  EXPECT_EQ(get(path("out")), "new");
  EXPECT_EQ(listing(), Names{"out"});
}

TEST_F(FileTest, WritesThroughASymbolicLink) {
  fs::create_directory(path("deep"));
  put("deep/real", "old");
  fs::create_symlink("deep/real", path("link"));
  fs::create_symlink("link", path("link-to-link"));
  ASSERT_TRUE(write_file(path("link-to-link"), "new").ok());
  EXPECT_TRUE(fs::is_symlink(path("link-to-link")));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(get(path("deep/real")), "new");
}

TEST_F(FileTest, WritesThroughADanglingSymbolicLink) {
  fs::create_symlink("later", path("link"));
  ASSERT_TRUE(write_file(path("link"), "new").ok());
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(get(path("later")), "new");
}

TEST_F(FileTest, SymbolicLinksInACircleAreAnError) {
  fs::create_symlink("b", path("a"));
  fs::create_symlink("a", path("b"));
  EXPECT_FALSE(InputFile::open(path("a")).ok());
  const Names before = listing();
  (void)OutputFile::create(path("a"));
  EXPECT_EQ(listing(), before);
}

TEST_F(FileTest, KeepsTheModeOfTheFileItReplaces) {
  put("out", "old");
  ASSERT_EQ(chmod(path("out").c_str(), 0640), 0);
  ASSERT_TRUE(write_file(path("out"), "new").ok());
  struct stat status {};
  ASSERT_EQ(stat(path("out").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640u);
}

TEST_F(FileTest, NewFilesHaveTheUsualMode) {
  put("usual", "x");
  ASSERT_TRUE(write_file(path("out"), "new").ok());
  struct stat usual {
  }, status{};
  ASSERT_EQ(stat(path("usual").c_str(), &usual), 0);
  ASSERT_EQ(stat(path("out").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode, usual.st_mode);
}

// The mode mask can only be read by setting it; threads that did so at once lost it.
TEST_F(FileTest, ThreadsLeaveTheModeMaskAlone) {
  const mode_t before = umask(027);
  umask(before);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 50; ++i) {
        EXPECT_TRUE(write_file(path("f" + std::to_string(t * 100 + i)), "x").ok());
      }
    });
  }
  for (auto& thread : threads) thread.join();
  const mode_t after = umask(before);
  EXPECT_EQ(after, before);
  EXPECT_EQ(listing().size(), 200u);
}

TEST_F(FileTest, AFullDeviceIsAnErrorAndStaysADevice) {
  const Status status = write_file("/dev/full", "text");
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "file-unwritable");
  EXPECT_NE(status.error().message.find("No space left"), std::string::npos);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(FileTest, TheFirstFailureIsKept) {
  auto file = OutputFile::create("/dev/full");
  ASSERT_TRUE(file.ok());
  EXPECT_FALSE(file->can_overwrite());
  EXPECT_FALSE(file->overwrite(0, {}).ok());
  EXPECT_FALSE(file->write(std::string(1 << 20, 'x')).ok());
  EXPECT_FALSE(file->write("y").ok());
  EXPECT_FALSE(file->commit().ok());
}

TEST_F(FileTest, DevicesAreWrittenDirectly) {
  EXPECT_TRUE(write_file("/dev/null", "text").ok());
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(FileTest, AFolderCannotBeWritten) {
  const auto file = OutputFile::create(folder_.string());
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().code, "file-directory");
}

TEST_F(FileTest, AMissingFolderIsNamed) {
  const auto file = OutputFile::create(path("no/such/out"));
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().code, "file-unwritable");
  EXPECT_NE(file.error().message.find(path("no/such")), std::string::npos);
}

TEST_F(FileTest, AFolderWithoutWritePermissionIsAnError) {
  if (geteuid() == 0) {
    // Permissions do not bind root; the kernel's own folder does.
    const auto file = OutputFile::create("/proc/out");
    ASSERT_FALSE(file.ok());
    EXPECT_EQ(file.error().code, "file-unwritable");
    return;
  }
  ASSERT_EQ(chmod(folder_.c_str(), 0500), 0);
  const auto file = OutputFile::create(path("out"));
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().code, "file-unwritable");
}

TEST_F(FileTest, AnEmptyNameIsAnError) {
  EXPECT_FALSE(OutputFile::create("").ok());
}

TEST(FileNames, BaseNameAndExtension) {
  EXPECT_EQ(base_name("/a/b/walk.bvh"), "walk.bvh");
  EXPECT_EQ(base_name("walk.bvh"), "walk.bvh");
  EXPECT_EQ(extension("/a.b/Walk.BVH"), ".bvh");
  EXPECT_EQ(extension("/a.b/walk"), "");
  EXPECT_EQ(extension("take.1.anim"), ".anim");
}

// A child writes half a file, then gets the signal.
class SignalTest : public FileTest, public testing::WithParamInterface<int> {
 protected:
  // What the child ended with: its signal, or 0 for an ordinary end.
  int end_child_by(int signal_number, bool ignored) {
    int ready[2];
    EXPECT_EQ(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
      if (ignored) signal(signal_number, SIG_IGN);
      remove_temporaries_on_signals();
      auto file = OutputFile::create(path("out"));
      if (!file || !file->write(std::string(1 << 20, 'n'))) _exit(9);
      (void)!write(ready[1], "x", 1);
      if (ignored) {
        raise(signal_number);
        _exit(file->commit().ok() ? 0 : 8);
      }
      for (;;) pause();
    }
    char byte = 0;
    EXPECT_EQ(read(ready[0], &byte, 1), 1);
    if (!ignored) kill(child, signal_number);
    int status = 0;
    waitpid(child, &status, 0);
    close(ready[0]);
    close(ready[1]);
    return WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
  }
};

TEST_P(SignalTest, RemovesTheTemporaryFileAndKeepsTheOldOne) {
  if (sanitized() && (GetParam() == SIGBUS || GetParam() == SIGSEGV)) {
    GTEST_SKIP() << "skipped: a sanitizer answers to this signal itself";
  }
  put("out", "old");
  EXPECT_EQ(end_child_by(GetParam(), false), GetParam());
  EXPECT_EQ(get(path("out")), "old");
  EXPECT_EQ(listing(), Names{"out"});
}

TEST_P(SignalTest, ASignalThatWasIgnoredStaysSo) {
  put("out", "old");
  EXPECT_EQ(end_child_by(GetParam(), true), 0);
  EXPECT_EQ(get(path("out")), std::string(1 << 20, 'n'));
}

INSTANTIATE_TEST_SUITE_P(Signals, SignalTest,
                         testing::Values(SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT, SIGALRM,
                                         SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2, SIGPOLL, SIGXCPU,
                                         SIGABRT, SIGBUS, SIGSEGV));

TEST_F(FileTest, MemoryGivenBackIsReadAgain) {
  std::string text;
  for (int i = 0; text.size() < (std::size_t{9} << 20); ++i) text += std::to_string(i) + "\n";
  put("long", text);
  const auto file = InputFile::open(path("long"));
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file->checksum(), xxh3(file->bytes()));
  for (const std::size_t offset : {std::size_t{1}, text.size() / 2, text.size(), text.size() * 2}) {
    file->release_before(offset);
    EXPECT_EQ(file->text(), text);
  }
  EXPECT_EQ(file->checksum(), xxh3(file->bytes()));
}

TEST_F(FileTest, ChecksumOfAnEmptyFileIsThatOfNoBytes) {
  put("empty", "");
  EXPECT_EQ(InputFile::open(path("empty"))->checksum(), xxh3({}));
}

}  // namespace
}  // namespace krok
