// If these fail, `krok VERB` does something else than `krok-VERB`, or progress gets into what
// scripts read.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using Json = nlohmann::ordered_json;

class Krok : public CliTest {
 protected:
  Krok() { put("in.bvh", capture(30)); }

  // A command for the shell, where git has no settings but the folder's.
  ToolRun in_git(const std::string& command) const {
    return run({"/bin/sh", "-c",
                "export PATH='" + tools_folder() + "':$PATH HOME=. GIT_CONFIG_NOSYSTEM=1; cd '" +
                    folder_.string() + "' && " + command});
  }
};

TEST_F(Krok, PassesArgumentsAndExitCodesThrough) {
  put("other.bvh", capture(30, "0.5"));
  const ToolRun import = run_tool("krok", {"import", path("in.bvh"), "-o", path("a b.anim")});
  EXPECT_EQ(import.exit_code, 0) << import.err;
  ASSERT_EQ(run_tool("krok", {"import", path("other.bvh"), "-o", path("c.anim")}).exit_code, 0);
  const ToolRun different = run_tool("krok", {"diff", path("a b.anim"), path("c.anim")});
  EXPECT_EQ(different.exit_code, 1) << different.err;
  EXPECT_EQ(different.out, run_tool("krok-diff", {path("a b.anim"), path("c.anim")}).out);
  const ToolRun missing = run_tool("krok", {"info", path("none.anim")});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_TRUE(has_code(missing.err, "file-missing")) << missing.err;
  EXPECT_EQ(run_tool("krok", {"info", "--help"}).out, run_tool("krok-info", {"--help"}).out);
}

TEST_F(Krok, HelpOfAVerbIsThatOfItsTool) {
  const std::string help = run_tool("krok-synth", {"--help"}).out;
  EXPECT_EQ(run_tool("krok", {"help", "synth"}).out, help);
  EXPECT_EQ(run_tool("krok", {"synth", "help"}).out, help);
  EXPECT_EQ(run_tool("krok", {"help", "dance"}).exit_code, 2);
  const std::string of_fit = run_tool("krok-fit", {"--help"}).out;  // a program of its own
  EXPECT_NE(of_fit, "");
  EXPECT_EQ(run_tool("krok", {"help", "fit"}).out, of_fit);
  EXPECT_EQ(run_tool("krok", {"fit", "--help"}).out, of_fit);
}

// Would fail if help were cut off or broken within words in a narrow terminal.
TEST_F(Krok, HelpIsAsWideAsTheTerminal) {
  const auto words_of = [](const std::string& text) {
    std::istringstream stream(text);
    return std::vector<std::string>(std::istream_iterator<std::string>(stream), {});
  };
  const std::string usual = run_tool("krok-edit", {"--help"}).out;
  for (const unsigned short columns : {50, 80, 300}) {
    winsize size{};
    size.ws_row = 40;
    size.ws_col = columns;
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
    ASSERT_GE(child, 0);
    if (child == 0) {
      const std::string program = test::tools_folder() + "/krok-edit";
      execl(program.c_str(), program.c_str(), "--help", nullptr);
      _exit(127);
    }
    std::string text;
    char buffer[4096];
    for (ssize_t n = 0; (n = ::read(terminal, buffer, sizeof buffer)) > 0;) {
      text.append(buffer, static_cast<std::size_t>(n));
    }
    int status = 0;
    waitpid(child, &status, 0);
    close(terminal);
    EXPECT_EQ(status, 0);
    std::erase(text, '\r');
    std::size_t longest = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      // What cannot be broken, such as an example's command, may be longer.
      if (line.find(' ', line.find_first_not_of(' ')) == std::string::npos) continue;
      longest = std::max(longest, line.size());
    }
    EXPECT_LE(longest, std::min<std::size_t>(columns, 100));
    EXPECT_EQ(words_of(text), words_of(usual)) << columns;
  }
}

// `krok --help` says of each verb what its tool says of itself.
TEST_F(Krok, HelpHasTheSummariesOfTheTools) {
  const std::string help = run_tool("krok", {"--help"}).out;
  std::istringstream lines(help.substr(help.find("Verbs:\n") + 7));
  int verbs = 0;
  for (std::string line; std::getline(lines, line) && !line.empty(); ++verbs) {
    const std::string verb = line.substr(2, line.find(' ', 2) - 2);
    const std::string own = run_tool("krok-" + verb, {"--help"}).out;
    EXPECT_EQ(line.substr(12), own.substr(0, own.find('\n'))) << verb;
    EXPECT_LE(line.size(), 88u) << line;
  }
  EXPECT_GT(verbs, 20);
}

TEST_F(Krok, TellsWhichVerbThereIsNot) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"dance"}, {"dance", "--help"}, {"../krok-info"}, {}}) {
    const ToolRun run = run_tool("krok", arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
    EXPECT_NE(run.err.find("hint: see krok --help"), std::string::npos) << run.err;
  }
}

TEST_F(Krok, AConversionIsNamedByWhatIsToBeWritten) {
  EXPECT_NE(run_tool("krok", {"convert", "a.bvh", "b.npz"}).err.find("krok export a.bvh -o b.npz"),
            std::string::npos);
  EXPECT_NE(
      run_tool("krok", {"convert", "a.bvh", "b.anim"}).err.find("krok import a.bvh -o b.anim"),
      std::string::npos);
}

// The tools stand beside the program itself, not beside a link to it.
TEST_F(Krok, WorksThroughALink) {
  std::filesystem::create_symlink(test::tools_folder() + "/krok", path("k"));
  const ToolRun run = test::run({path("k"), "info", "--version"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, run_tool("krok-info", {"--version"}).out);
}

// If it fails, `git diff` shows nothing of a motion, or thousands of lines for one joint, or lines
// where only the digits of a file changed; or it ends with an error on a machine where git does not
// know who commits.
TEST_F(Krok, GitShowsWhatChangedInAMotion) {
  if (!std::filesystem::exists("/usr/bin/git")) GTEST_SKIP() << "skipped: there is no git";
  const auto changed_lines = [&] {
    const ToolRun diff = in_git("git diff --no-color in.bvh");
    EXPECT_EQ(diff.exit_code, 0) << diff.err;
    const std::string& text = diff.out;
    int count = 0;
    for (std::size_t i = 0; (i = text.find("\n+", i)) != std::string::npos; ++i) ++count;
    return count - (count > 0 ? 1 : 0);  // the header's
  };
  put("pointer.bvh", "version https://git-lfs.github.com/spec/v1\noid sha256:12ab\nsize 99\n");
  put("broken.bvh", "HIERARCHY\nROOT");
  const ToolRun setup = in_git("git init -q . && krok git-setup && git add . ");
  ASSERT_EQ(setup.exit_code, 0) << setup.err;
  EXPECT_EQ(changed_lines(), 0);
  std::string text = capture(30);
  put("in.bvh", capture(30, "0.0001"));
  EXPECT_GE(changed_lines(), 1);
  EXPECT_LE(changed_lines(), 5);
  for (std::size_t i = 0; (i = text.find(" 0.4 ", i)) != std::string::npos; ++i) {
    text.replace(i, 5, " 0.400000 ");
  }
  put("in.bvh", text);
  EXPECT_EQ(changed_lines(), 0);
  // Nor do its rounding errors: 0.00005 degrees in all frames.
  const auto turned = [&](const char* angle) {
    std::string other = text;
    for (std::size_t i = 0; (i = other.find(" 0 10\n", i)) != std::string::npos;) {
      other.replace(i, 6, angle);
    }
    put("turned.bvh", other);
    return run_here("krok-info", {"--textconv", "turned.bvh"}).out;
  };
  EXPECT_EQ(turned(" 0 9.99916\n"), turned(" 0 9.99921\n"));
  EXPECT_NE(turned(" 0 9.99916\n"), turned(" 0 9.98\n"));
  EXPECT_EQ(run_here("krok-info", {"--textconv", "pointer.bvh"}).out,
            "Git LFS pointer: oid sha256:12ab size 99\n");
  const ToolRun broken = run_here("krok-info", {"--textconv", "broken.bvh"});
  EXPECT_EQ(broken.exit_code, 0);
  EXPECT_THAT(broken.out, StartsWith("cannot be read: "));
}

// If it fails, a commit ends without a word of why, or for faults that are known.
TEST_F(Krok, TheHookNamesTheFaultsOfACommit) {
  if (!std::filesystem::exists("/usr/bin/git")) GTEST_SKIP() << "skipped: there is no git";
  put("in.bvh", capture(30, "9"));
  ASSERT_EQ(in_git("git init -q . && git config user.name a && git config user.email a@b.c && krok "
                   "git-setup --hook && git add .")
                .exit_code,
            0);
  const ToolRun refused = in_git("git commit -m one");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.out + refused.err,
              AllOf(HasSubstr("[pop]"), HasSubstr("git commit --no-verify")));
  in_git("krok lint . --save-baseline krok-lint.json");
  const ToolRun known = in_git("git commit -m one");
  EXPECT_EQ(known.exit_code, 0) << known.out << known.err;
}

// Would fail if the Action's step linted motions that nobody touched, or passed what is faulty.
TEST_F(Krok, TheActionLintsAndComparesWhatChanged) {
  if (!std::filesystem::exists("/usr/bin/git")) GTEST_SKIP() << "skipped: there is no git";
  const std::string action = get(test::source_folder() + "/action.yml");
  put("step.sh", action.substr(action.rfind("run: |") + 6));
  put("untouched.bvh", capture(30, "9"));
  ASSERT_EQ(in_git("git init -q . && git config user.name a && git config user.email a@b.c && git "
                   "add *.bvh && git commit -qm one")
                .exit_code,
            0);
  const std::string step = "SINCE=HEAD~1 bash -e -o pipefail step.sh";
  const ToolRun none = in_git("git commit -qm none --allow-empty; " + step);
  EXPECT_EQ(none.exit_code, 0) << none.out << none.err;
  put("in.bvh", capture(30, "9"));
  const ToolRun faulty = in_git("git commit -qam two; " + step);
  EXPECT_EQ(faulty.exit_code, 1) << faulty.err;
  EXPECT_THAT(faulty.out, AllOf(HasSubstr("differs: positions"), HasSubstr("in.bvh: 0.03 s: error"),
                                Not(HasSubstr("untouched"))));
}

TEST_F(Krok, AFullStandardOutputIsTrouble) {
  ToolOptions full;
  full.output_path = "/dev/full";
  for (const char* option : {"--help", "--version"}) {
    const ToolRun run = run_tool("krok", {option}, full);
    EXPECT_EQ(run.exit_code, 2) << option;
    EXPECT_TRUE(has_code(run.err, "file-unwritable")) << run.err;
    EXPECT_EQ(run_tool("krok", {option}).exit_code, 0);
  }
}

TEST_F(Krok, ProgressInJsonIsAnObjectALine) {
  const ToolRun run =
      run_tool("krok-import", {path("in.bvh"), "--out-dir", path("out"), "-q", "--progress=json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  std::istringstream lines(run.err);
  int count = 0;
  std::uint64_t done = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const Json progress = Json::parse(line)["progress"];
    EXPECT_EQ(progress["total"], 1);
    EXPECT_FALSE(progress["what"].get<std::string>().empty());
    done = progress["done"].get<std::uint64_t>();
  }
  EXPECT_GE(count, 2);
  EXPECT_EQ(done, 1u);
}

TEST_F(Krok, ProgressInPlainLinesAndNoneWithoutATerminal) {
  const ToolRun plain =
      run_tool("krok-import", {path("in.bvh"), "--out-dir", path("out"), "-q", "--progress=plain"});
  EXPECT_EQ(plain.err.find("krok-import: 0/1 (0 %)\n"), 0u) << plain.err;
  EXPECT_NE(plain.err.find("1/1 (100 %)\n"), std::string::npos) << plain.err;
  for (const char* style : {"auto", "none"}) {
    const ToolRun run = run_tool("krok-import", {path("in.bvh"), "--out-dir", path("out"), "-q",
                                                 "--force", std::string("--progress=") + style});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "") << style;
  }
}

// On a terminal, which script(1) makes: a bar that is taken away in the end, coloured unless
// NO_COLOR says otherwise.
TEST_F(Krok, ABarOnATerminalHonoursNoColor) {
  if (!std::filesystem::exists("/usr/bin/script")) GTEST_SKIP() << "skipped: there is no script";
  put("long.bvh", capture(150000));
  std::filesystem::create_directory(path("in"));
  for (int i = 0; i < 40; ++i) {
    std::filesystem::create_hard_link(path("long.bvh"), path("in/" + std::to_string(i) + ".bvh"));
  }
  const auto bar = [&](const std::string& environment) {
    const std::string command = environment + " " + test::tools_folder() + "/krok-import " +
                                path("in") + " --out-dir " + path("out") +
                                " --force -j 1 --progress=bar";
    ToolOptions options;
    options.folder = folder_.string();
    return test::run({"/usr/bin/script", "-qec", command, "/dev/null"}, options).out;
  };
  const std::string coloured = bar("env -u NO_COLOR");
  const std::string plain = bar("NO_COLOR=1");
  for (const std::string& text : {coloured, plain}) {
    const std::size_t first = text.find("####");
    ASSERT_NE(first, std::string::npos) << text;
    EXPECT_NE(text.find("\r\033[K", first), std::string::npos) << "the bar stays: " << text;
    EXPECT_NE(text.find("40 files, 40 done"), std::string::npos) << text;
  }
  EXPECT_NE(coloured.find("\033[32m"), std::string::npos);
  EXPECT_EQ(plain.find("\033[32m"), std::string::npos);
}

}  // namespace
}  // namespace krok::test
