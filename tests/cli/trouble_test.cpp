// If these fail, a tool ends with success after an error, says nothing useful, or destroys a file.
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "cli/fixture.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class Trouble : public CliTest {
 protected:
  // Runs an import that must fail with this code and leave nothing.
  void expect_import_fails(const std::string& input, const std::string& output,
                           const std::string& code) {
    const Names before = listing();
    const ToolRun run = run_tool("krok-import", {input, "-o", output});
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(has_code(run.err, code)) << run.err;
    EXPECT_NE(run.err.find("error: "), std::string::npos) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(listing(), before);
  }
};

TEST_F(Trouble, MissingFile) {
  expect_import_fails(path("none.bvh"), path("out.anim"), "file-missing");
}

TEST_F(Trouble, AFolderAsInput) {
  expect_import_fails(folder_.string(), path("out.anim"), "file-directory");
}

TEST_F(Trouble, AnEmptyFile) {
  put("in.bvh", "");
  expect_import_fails(path("in.bvh"), path("out.anim"), "bvh-kind");
}

TEST_F(Trouble, SomethingElse) {
  put("in.bvh", "This is a letter.\n");
  expect_import_fails(path("in.bvh"), path("out.anim"), "bvh-kind");
}

TEST_F(Trouble, AFileCutInItsHierarchy) {
  put("in.bvh", capture(5).substr(0, 150));
  const ToolRun run = run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim")});
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_NE(run.err.find("in.bvh:"), std::string::npos) << "file and line: " << run.err;
  EXPECT_EQ(listing(), Names{"in.bvh"});
}

TEST_F(Trouble, AFileCutInItsMotionIsRefusedWhenStrict) {
  const std::string text = capture(5);
  put("in.bvh", text.substr(0, text.size() - 8));
  const ToolRun strict =
      run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "--strict"});
  EXPECT_EQ(strict.exit_code, 2) << strict.err;
  EXPECT_EQ(listing(), Names{"in.bvh"});
  const ToolRun usual = run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim")});
  EXPECT_EQ(usual.exit_code, 0) << usual.err;
  EXPECT_NE(usual.err.find("warning: "), std::string::npos) << usual.err;
}

TEST_F(Trouble, NumbersThatAreNone) {
  for (const char* value : {"nan", "inf", "-Infinity", "12.3abc", "1e999", "1,5", "0x10"}) {
    put("in.bvh", capture(5, value));
    const ToolRun run = run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim")});
    EXPECT_EQ(run.exit_code, 2) << value << "\n" << run.err;
    EXPECT_TRUE(has_code(run.err, "bvh-number")) << run.err;
    // The second row stands on line 25 of the file.
    EXPECT_NE(run.err.find("in.bvh:25:5: error"), std::string::npos) << run.err;
    EXPECT_EQ(listing(), Names{"in.bvh"});
  }
}

TEST_F(Trouble, OwnFormatsThatAreCutOrChanged) {
  put("in.bvh", capture(20));
  ASSERT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("good.anim")}).exit_code, 0);
  const std::string good = get(path("good.anim"));
  std::string changed = good;
  changed[changed.size() / 2] = static_cast<char>(changed[changed.size() / 2] ^ 1);
  put("cut.anim", good.substr(0, good.size() / 2));
  put("changed.anim", changed);
  put("empty.anim", "");
  for (const char* name : {"cut.anim", "changed.anim", "empty.anim"}) {
    const ToolRun run = run_tool("krok-export", {path(name), "-o", path("out.csv")});
    EXPECT_EQ(run.exit_code, 2) << name;
    EXPECT_NE(run.err.find(name), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(path("out.csv")));
  }
}

TEST_F(Trouble, AMissingOutputFolder) {
  put("in.bvh", capture(5));
  expect_import_fails(path("in.bvh"), path("no/such/out.anim"), "file-unwritable");
}

TEST_F(Trouble, AFolderAsOutput) {
  put("in.bvh", capture(5));
  fs::create_directory(path("out.anim"));
  expect_import_fails(path("in.bvh"), path("out.anim"), "file-directory");
}

TEST_F(Trouble, AFolderThatCannotBeWritten) {
  put("in.bvh", capture(5));
  if (geteuid() == 0) {
    expect_import_fails(path("in.bvh"), "/proc/out.anim", "file-unwritable");
    return;
  }
  fs::create_directory(path("locked"));
  ASSERT_EQ(chmod(path("locked").c_str(), 0500), 0);
  expect_import_fails(path("in.bvh"), path("locked/out.anim"), "file-unwritable");
}

TEST_F(Trouble, AReadOnlyOutputStays) {
  if (geteuid() == 0) GTEST_SKIP() << "skipped: permissions do not bind root";
  put("in.bvh", capture(5));
  put("out.anim", "old");
  ASSERT_EQ(chmod(path("out.anim").c_str(), 0400), 0);
  expect_import_fails(path("in.bvh"), path("out.anim"), "file-unwritable");
  EXPECT_EQ(get(path("out.anim")), "old");
}

TEST_F(Trouble, AFullDevice) {
  put("in.bvh", capture(5));
  expect_import_fails(path("in.bvh"), "/dev/full", "file-unwritable");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(Trouble, AFullStandardOutput) {
  put("in.bvh", capture(50));
  ASSERT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("a.anim")}).exit_code, 0);
  ToolOptions full;
  full.output_path = "/dev/full";
  EXPECT_EQ(run_tool("krok-info", {path("a.anim")}, full).exit_code, 2);
  EXPECT_EQ(run_tool("krok-info", {path("a.anim"), "--json"}, full).exit_code, 2);
  EXPECT_EQ(run_tool("krok-info", {"--help"}, full).exit_code, 2);
  EXPECT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", "-"}, full).exit_code, 2);
}

TEST_F(Trouble, AFullDiskKeepsTheOldFile) {
  fs::create_directory(path("disk"));
  if (mount("none", path("disk").c_str(), "tmpfs", 0, "size=256k") != 0) {
    GTEST_SKIP() << "skipped: a small file system cannot be mounted here";
  }
  put("disk/out.anim", "old");
  put("in.bvh", capture(20000));
  const ToolRun run = run_tool("krok-import", {path("in.bvh"), "-o", path("disk/out.anim")});
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(path("disk")))
    left.push_back(entry.path().filename());
  const std::string still = get(path("disk/out.anim"));
  umount(path("disk").c_str());
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_TRUE(has_code(run.err, "file-unwritable")) << run.err;
  EXPECT_NE(run.err.find("No space left"), std::string::npos) << run.err;
  EXPECT_EQ(left, Names{"out.anim"});
  EXPECT_EQ(still, "old");
}

TEST_F(Trouble, NoClobberRefuses) {
  put("in.bvh", capture(5));
  put("out.anim", "old");
  const ToolRun run =
      run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "--no-clobber"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "file-exists")) << run.err;
  EXPECT_EQ(get(path("out.anim")), "old");
  EXPECT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim")}).exit_code, 0);
  EXPECT_NE(get(path("out.anim")), "old");
}

TEST_F(Trouble, AnInputWithAFaultStays) {
  put("broken.bvh", capture(5, "nan"));
  const std::string broken = get(path("broken.bvh"));
  EXPECT_EQ(run_tool("krok-import", {path("broken.bvh"), "-o", path("broken.bvh")}).exit_code, 2);
  EXPECT_EQ(get(path("broken.bvh")), broken);
  EXPECT_EQ(listing(), Names{"broken.bvh"});
}

class Signals : public CliTest, public testing::WithParamInterface<int> {};

// Whether a process has an output open that has no name yet.
bool has_unnamed_output(pid_t process) {
  std::error_code ended;
  const std::string folder = "/proc/" + std::to_string(process) + "/fd";
  for (const auto& entry : std::filesystem::directory_iterator(folder, ended)) {
    const std::string target = std::filesystem::read_symlink(entry.path(), ended).string();
    if (target.find("/#") != std::string::npos && target.ends_with(" (deleted)")) return true;
  }
  return false;
}

// As soon as the output is begun, or the tool has run for a while, the signal comes.
TEST_P(Signals, InTheMiddleLeaveTheOldOutput) {
  put("in.bvh", capture(200000));
  put("out.anim", "old");
  ToolOptions options;
  int looks = 0;
  options.meanwhile = [&](pid_t child) {
    const bool writing = listing().size() > 2 || has_unnamed_output(child);
    if (!writing && ++looks < 20000) return false;
    kill(child, GetParam());
    return true;
  };
  const ToolRun run =
      run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "-q"}, options);
  ASSERT_FALSE(run.timed_out);
  if (run.signal != 0) {
    EXPECT_EQ(run.signal, GetParam());
  }
  // The output may have been in place before the signal came; then the file is whole.
  if (run.signal == 0 || get(path("out.anim")) != "old") {
    EXPECT_EQ(run_tool("krok-info", {path("out.anim")}).exit_code, 0);
  }
  EXPECT_EQ(listing(), (Names{"in.bvh", "out.anim"}));
}

TEST_P(Signals, WhileReadingLeaveTheOldOutput) {
  put("in.bvh", capture(200000));
  put("out.anim", "old");
  ToolOptions options;
  int looks = 0;
  options.meanwhile = [&](pid_t child) {
    if (++looks < 20) return false;
    kill(child, GetParam());
    return true;
  };
  const ToolRun run = run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim")}, options);
  EXPECT_EQ(run.signal, GetParam()) << run.exit_code << run.err;
  EXPECT_EQ(get(path("out.anim")), "old");
  EXPECT_EQ(listing(), (Names{"in.bvh", "out.anim"}));
}

// A file that keeps another library busy ends every tool at the user's limit, not at ours.
TEST_F(Trouble, LimitsOfOtherLibrariesAreTheUsers) {
  put("in.bvh", capture(5));
  put("in.smd",
      "version 1\nnodes\n0 \"root\" -1\n1 \"a\" 0\nend\nskeleton\ntime 0\n0 0 0 0 0 0 0\n1 0 0 1 0 "
      "0 0\ntime 1\n0 0 0 0 0 0 0\n1 0 0 2 0 0 0\nend\n");
  const std::vector<std::vector<std::string>> commands = {
      {"krok-info", "in.smd"},
      {"krok-import", "in.smd", "-o", "out.anim"},
      {"krok-view", "in.bvh", "--ground", "in.smd", "-o", "out.html"},
      {"krok-plot", "in.bvh", "--ground", "in.smd", "--sheet", "out.png"},
      {"krok-plot", "in.bvh", "in.smd", "--sheet", "out.png"},
      {"krok-ik", "in.bvh", "--reach", "Head=0,1,0@0s", "--ground", "in.smd", "-o", "out.anim"},
  };
  for (const auto& command : commands) {
    SCOPED_TRACE(command[0]);
    std::vector<std::string> arguments(command.begin() + 1, command.end());
    arguments.insert(arguments.end(), {"--limit-time", "0.00001"});
    const ToolRun run = run_here(command[0], arguments);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(has_code(run.err, "assimp-time")) << run.err;
    EXPECT_THAT(run.err, HasSubstr("after 0.0001 seconds"));
    EXPECT_THAT(run.err, HasSubstr("--limit-time"));
    EXPECT_EQ(listing(), (Names{"in.bvh", "in.smd"}));
  }
}

INSTANTIATE_TEST_SUITE_P(All, Signals, testing::Values(SIGTERM, SIGINT, SIGHUP));

}  // namespace
}  // namespace krok::test
