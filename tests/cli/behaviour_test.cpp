// If these fail, scripts that use the tools break: exit codes, streams, reports, and the promise
// that the same input gives the same bytes.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using Json = nlohmann::ordered_json;

// All programs that were built, but the one that runs them.
std::vector<std::string> built_tools() {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(tools_folder())) {
    const std::string name = file.path().filename();
    if (name.starts_with("krok-")) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

class Tools : public CliTest, public testing::WithParamInterface<std::string> {};

TEST_P(Tools, HelpAndVersionEndWithSuccess) {
  for (const std::string option : {"--help", "-h"}) {
    const ToolRun run = run_tool(GetParam(), {option});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "");
    for (const char* part : {"Usage: krok-", "Examples:", "--json", "--progress", "--help"}) {
      EXPECT_NE(run.out.find(part), std::string::npos) << part << "\n" << run.out;
    }
    EXPECT_EQ(run.out.find("Exit codes:") != std::string::npos, option == "--help") << run.out;
  }
  const ToolRun version = run_tool(GetParam(), {"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.find(GetParam() + " "), 0u) << version.out;
}

// Somebody who asks for -h wants to see the command at a glance, and no option to be missing.
TEST_P(Tools, ShortHelpFitsAScreenAndNamesEveryOption) {
  const std::string help = run_tool(GetParam(), {"--help"}).out;
  const std::string text = run_tool(GetParam(), {"-h"}).out;
  EXPECT_LT(std::ranges::count(text, '\n'), 70) << text;
  for (std::size_t at = 0; (at = help.find("\n  --", at)) != std::string::npos; ++at) {
    const std::size_t begin = at + 3;
    const std::string name = help.substr(begin, help.find_first_of(" ,\n=", begin) - begin);
    EXPECT_NE(text.find(name), std::string::npos) << name << "\n" << text;
  }
}

TEST_P(Tools, HelpReadsWell) {
  const std::string help = run_tool(GetParam(), {"--help"}).out;
  // "{sequence}" stands in the texts; options have no such names.
  for (std::size_t at = 0; (at = help.find("\n  -", at)) != std::string::npos; ++at) {
    const std::string name =
        help.substr(at + 1, std::min<std::size_t>(34, help.find('\n', at + 1) - at));
    EXPECT_EQ(name.find('{'), std::string::npos) << "as CLI11 prints it: " << name;
  }
  // CLI11's names for types stand after a name, "--every INT".
  for (const char* type : {" TEXT", " INT", " UINT", " FLOAT", " BOOLEAN"}) {
    EXPECT_EQ(help.find(type), std::string::npos) << help;
  }
  EXPECT_EQ(help.find("\n\n\n"), std::string::npos) << help;
  for (std::size_t at = 0; at < help.size();) {
    const std::size_t end = std::min(help.find('\n', at), help.size());
    const std::string line = help.substr(at, end - at);
    const bool command = line.find("  krok-") == 0 || line.find("Usage:") == 0;
    EXPECT_TRUE(command || line.size() <= 100) << line;
    at = end + 1;
  }
}

TEST_P(Tools, WrongUsageEndsWithTwo) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--no-such-option"},
                                                    {},
                                                    {"--progress=loud"},
                                                    {"-j", "many"},
                                                    {"-j", "2x"},
                                                    {"-j", "0x2"},
                                                    {"-j", " 2"},
                                                    {"-j", "1025"},
                                                    {"-j", "-1"}}) {
    const ToolRun run = run_tool(GetParam(), arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run.err.find(GetParam() + ": error: "), 0u) << run.err;
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
    EXPECT_NE(run.err.find("\n  hint: "), std::string::npos) << run.err;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Tools, testing::ValuesIn(built_tools()),
                         [](const auto& test_case) { return test_case.param.substr(5); });

class Behaviour : public CliTest {
 protected:
  Behaviour() { put("in.bvh", capture(40)); }
};

TEST_F(Behaviour, JsonAloneGoesToStandardOutput) {
  // Before a positional argument too, which must not be taken for its value.
  const ToolRun run = run_tool("krok-import", {"--json", path("in.bvh"), "-o", path("out.anim")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["schema"], "krok.report/1");
  EXPECT_EQ(report["tool"], "krok-import");
  EXPECT_EQ(report["inputs"][0]["path"], path("in.bvh"));
  EXPECT_EQ(report["inputs"][0]["xxh3"].get<std::string>().size(), 16u);
  EXPECT_EQ(report["outputs"][0], path("out.anim"));
  std::vector<std::string> keys;
  for (const auto& item : report.items()) keys.push_back(item.key());
  EXPECT_EQ(keys, (std::vector<std::string>{"schema", "tool", "version", "inputs", "options",
                                            "outputs", "issues", "result"}));
}

TEST_F(Behaviour, JsonWithAFileGoesThere) {
  const ToolRun run =
      run_tool("krok-import", {path("in.bvh"), "--json=" + path("r.json"), "-o", path("out.anim")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(Json::parse(get(path("r.json")))["tool"], "krok-import");
}

TEST_F(Behaviour, AnErrorStandsInTheReportToo) {
  const ToolRun run = run_tool("krok-import", {path("none.bvh"), "--json", "-o", path("out.anim")});
  EXPECT_EQ(run.exit_code, 2);
  const Json report = Json::parse(run.out);
  ASSERT_EQ(report["issues"].size(), 1u);
  EXPECT_EQ(report["issues"][0]["code"], "file-missing");
  EXPECT_EQ(report["issues"][0]["severity"], "error");
  EXPECT_TRUE(has_code(run.err, "file-missing"));
}

TEST_F(Behaviour, ReportAndDataCannotShareStandardOutput) {
  const ToolRun run = run_tool("krok-import", {path("in.bvh"), "--json", "-o", "-"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
}

TEST_F(Behaviour, QuietSaysNothing) {
  const ToolRun run = run_tool("krok-import", {path("in.bvh"), "-q", "-o", path("out.anim")});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.out + run.err, "");
}

TEST_F(Behaviour, StandardInputAndOutputTakePartInPipes) {
  ToolOptions piped;
  piped.input = get(path("in.bvh"));
  const ToolRun import = run_tool("krok-import", {"-", "-o", "-", "-q"}, piped);
  ASSERT_EQ(import.exit_code, 0) << import.err;
  put("piped.anim", import.out);
  EXPECT_EQ(run_tool("krok-info", {path("piped.anim")}).exit_code, 0);
  ToolOptions next;
  next.input = import.out;
  const ToolRun info = run_tool("krok-info", {"-"}, next);
  EXPECT_EQ(info.exit_code, 0) << info.err;
}

TEST_F(Behaviour, TheSameBytesAgainAndForAnyJobs) {
  put("in.bvh", capture(3000));
  std::string first;
  for (const char* jobs : {"1", "2", "2", "5", "0"}) {
    const ToolRun run =
        run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "-j", jobs});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    if (first.empty()) first = get(path("out.anim"));
    EXPECT_TRUE(get(path("out.anim")) == first) << jobs << " jobs";
  }
}

TEST_F(Behaviour, TheWholeWayGivesTheSameBytesForAnyJobs) {
  std::vector<std::string> glb;
  for (const char* jobs : {"1", "2"}) {
    const std::vector<std::vector<std::string>> steps = {
        {"krok-import", path("in.bvh"), "-o", path("a.anim")},
        {"krok-body", path("a.anim"), "-o", path("a.model"), "--detail", "low"},
        {"krok-skin", path("a.model"), path("a.anim"), "--as", "rig", "-o", path("a.glb")}};
    for (std::vector<std::string> step : steps) {
      const std::string tool = step.front();
      step.erase(step.begin());
      step.insert(step.end(), {"-j", jobs, "-q"});
      const ToolRun run = run_tool(tool, step);
      ASSERT_EQ(run.exit_code, 0) << tool << ": " << run.err;
    }
    glb.push_back(get(path("a.glb")));
  }
  EXPECT_FALSE(glb[0].empty());
  EXPECT_TRUE(glb[0] == glb[1]);
}

TEST_F(Behaviour, DiffAnswersWithItsExitCode) {
  put("other.bvh", capture(40, "0.5"));
  ASSERT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("a.anim")}).exit_code, 0);
  ASSERT_EQ(run_tool("krok-import", {path("other.bvh"), "-o", path("b.anim")}).exit_code, 0);
  EXPECT_EQ(run_tool("krok-diff", {path("a.anim"), path("a.anim")}).exit_code, 0);
  EXPECT_EQ(run_tool("krok-diff", {path("a.anim"), path("b.anim")}).exit_code, 1);
  EXPECT_EQ(run_tool("krok-diff",
                     {path("a.anim"), path("b.anim"), "--tolerance", "1m", "--angle", "1deg"})
                .exit_code,
            0);
  EXPECT_EQ(run_tool("krok-diff", {path("a.anim"), path("none.anim")}).exit_code, 2);
  EXPECT_EQ(
      run_tool("krok-diff", {path("a.anim"), path("b.anim"), "--tolerance", "12.3abc"}).exit_code,
      2);
}

TEST_F(Behaviour, NumbersOfOptionsMustParseWhole) {
  for (const char* fps : {"12.3abc", "nan", "inf", "", "-5", "0"}) {
    const ToolRun run =
        run_tool("krok-import", {path("in.bvh"), "-o", path("o.anim"), "--fps", fps});
    EXPECT_EQ(run.exit_code, 2) << fps << run.err;
    EXPECT_NE(run.err.find("error: "), std::string::npos) << run.err;
  }
}

// "010" is ten, and what is no decimal number is none.
TEST_F(Behaviour, NumbersAreDecimal) {
  ASSERT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("in.anim")}).exit_code, 0);
  const auto frames_at_speed = [&](const std::string& speed) {
    const ToolRun run = run_tool("krok-edit", {path("in.anim"), "-o", path("out.anim"),
                                               "--playback-speed", speed, "--json"});
    return run.exit_code == 0 ? Json::parse(run.out)["result"]["frames"].get<int>() : -1;
  };
  EXPECT_EQ(frames_at_speed("010"), frames_at_speed("10"));
  EXPECT_EQ(frames_at_speed("02"), 20);
  for (const char* number : {"0x10", " 2", "2 ", "1e999", "nan", "1_0", ""}) {
    EXPECT_EQ(frames_at_speed(number), -1) << number;
    const ToolRun rounds = run_tool(
        "krok-edit", {path("in.anim"), "-o", path("out.anim"), "--loop", "--rounds", number});
    EXPECT_EQ(rounds.exit_code, 2) << number;
    EXPECT_TRUE(has_code(rounds.err, "usage")) << rounds.err;
    const ToolRun digits =
        run_tool("krok-export", {path("in.anim"), "-o", path("out.bvh"), "--digits", number});
    EXPECT_EQ(digits.exit_code, 2) << number;
  }
  EXPECT_EQ(run_tool("krok-export", {path("in.anim"), "-o", path("out.bvh"), "--digits", "010"})
                .exit_code,
            0);
}

TEST_F(Behaviour, AFlagThatIsOffIsReportedSo) {
  ASSERT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("in.anim")}).exit_code, 0);
  for (const char* word : {"off", "no", "0", "false", "n"}) {
    const ToolRun run = run_tool("krok-edit", {path("in.anim"), "-o", path("out.anim"), "--json",
                                               std::string("--mirror=") + word});
    EXPECT_EQ(Json::parse(run.out)["options"]["mirror"], false) << word;
  }
  const ToolRun on =
      run_tool("krok-edit", {path("in.anim"), "-o", path("out.anim"), "--json", "--mirror=yes"});
  EXPECT_EQ(Json::parse(on.out)["options"]["mirror"], true);
}

// A program started with its standard streams closed must not write messages into files.
TEST_F(Behaviour, ClosedStandardStreamsAreNoTrouble) {
  const std::string tool = test::tools_folder() + "/krok-import";
  const ToolRun run = test::run(
      {"/bin/sh", "-c",
       "'" + tool + "' '" + path("in.bvh") + "' -v -o '" + path("out.anim") + "' 0<&- 1>&- 2>&-"});
  EXPECT_EQ(run.exit_code, 0);
  ASSERT_EQ(run_tool("krok-import", {path("in.bvh"), "-v", "-o", path("usual.anim")}).exit_code, 0);
  EXPECT_TRUE(get(path("out.anim")) == get(path("usual.anim")));
}

}  // namespace
}  // namespace krok::test
