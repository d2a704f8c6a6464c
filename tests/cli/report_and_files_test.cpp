// If these fail, a slip on the command line destroys a capture, a result depends on the folder that
// it was made in, or a script gets no report of what it did wrong.
#include <nlohmann/json.hpp>

#include "cli/fixture.h"

namespace krok::test {
namespace {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

class ReportAndFiles : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    put("in.bvh", capture(5));
  }
  // A motion and a body for it.
  void make_character() {
    ASSERT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("in.anim")}).exit_code, 0);
    const ToolRun body =
        run_tool("krok-body", {path("in.anim"), "--detail", "low", "-o", path("in.model")});
    ASSERT_EQ(body.exit_code, 0) << body.err;
  }
  void expect_usage_error(const ToolRun& run, const std::string& part) {
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  }
};

TEST_F(ReportAndFiles, AResultNeverReplacesItsInput) {
  std::filesystem::create_symlink(path("in.bvh"), path("link.bvh"));
  const std::string part = "in.bvh: error: is an input and would be overwritten";
  expect_usage_error(run_tool("krok-import", {path("in.bvh"), "-o", path("in.bvh")}), part);
  expect_usage_error(
      run_tool("krok-import",
               {path("in.bvh"), "-o", path("./../") + folder_.filename().string() + "/in.bvh"}),
      part);
  expect_usage_error(run_tool("krok-import", {path("in.bvh"), "-o", path("link.bvh")}), part);
  expect_usage_error(
      run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "--json=" + path("in.bvh")}),
      part);
  expect_usage_error(run_tool("krok-info", {path("in.bvh"), "--json=" + path("in.bvh")}), part);
  EXPECT_EQ(get(path("in.bvh")), capture(5));
  EXPECT_EQ(listing(), (Names{"in.bvh", "link.bvh"}));
}

TEST_F(ReportAndFiles, TwoResultsDoNotShareAFile) {
  expect_usage_error(run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"),
                                              "--json=" + path("out.anim")}),
                     "written twice");
  EXPECT_EQ(listing(), Names{"in.bvh"});
  const ToolRun devices =
      run_tool("krok-import", {path("in.bvh"), "-o", "/dev/null", "--json=/dev/null"});
  EXPECT_EQ(devices.exit_code, 0) << devices.err;
}

TEST_F(ReportAndFiles, StandardInputIsReadOnce) {
  ToolOptions options;
  options.input = capture(5);
  expect_usage_error(run_tool("krok-diff", {"-", "-"}, options), "only once");
}

// The file that a report goes to may stand among the arguments; then it is left alone.
TEST_F(ReportAndFiles, AUsageErrorStandsInTheReport) {
  const ToolRun run = run_tool("krok-import", {path("in.bvh"), "--nonsense", "--json"});
  EXPECT_EQ(run.exit_code, 2);
  const Json report = Json::parse(run.out);
  ASSERT_EQ(report["issues"].size(), 1u);
  EXPECT_EQ(report["issues"][0]["code"], "usage");
  run_tool("krok-import", {path("in.bvh"), "--nonsense", "--json=" + path("in.bvh")});
  EXPECT_EQ(get(path("in.bvh")), capture(5));
}

TEST_F(ReportAndFiles, NoFolderGetsIntoAResult) {
  std::filesystem::create_directory(path("a"));
  std::filesystem::create_directory(path("b"));
  ToolOptions options;
  options.folder = path("a");
  ASSERT_EQ(
      run_tool("krok-import", {"../in.bvh", "-o", "out.anim", "--save-model", "out.model"}, options)
          .exit_code,
      0);
  ASSERT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("b/out.anim"), "--save-model",
                                     path("b/other.model")})
                .exit_code,
            0);
  EXPECT_TRUE(get(path("a/out.anim")) == get(path("b/out.anim")));
  EXPECT_TRUE(get(path("a/out.model")) == get(path("b/other.model")));
}

TEST_F(ReportAndFiles, AWordThatIsNoneIsAnsweredWithTheWords) {
  const ToolRun progress =
      run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "--progress=loud"});
  expect_usage_error(progress, "--progress: 'loud' is not auto, bar, plain, json or none");
  // The numbers behind the words are no words.
  const ToolRun number = run_tool("krok-skin", {"a.model", "a.anim", "-o", "a.glb", "--as", "1"});
  expect_usage_error(number, "--as: '1' is not rig, motion, baked, pose or frames");
}

TEST_F(ReportAndFiles, OptionsThatWouldHaveNoEffectAreErrors) {
  make_character();
  const std::string model = path("in.model"), motion = path("in.anim"), out = path("out.glb");
  expect_usage_error(run_tool("krok-skin", {model, motion, "--time", "0", "-o", out}), "--time");
  expect_usage_error(
      run_tool("krok-skin", {model, motion, "--as", "pose", "--from", "1f", "-o", out}), "--from");
  expect_usage_error(run_tool("krok-export", {motion, "--bones", "-o", path("out.csv")}),
                     "--bones");
  EXPECT_EQ(listing(), (Names{"in.anim", "in.bvh", "in.model"}));
}

// The file that is at fault is named, not the one that was to be written.
TEST_F(ReportAndFiles, MessagesNameTheFileConcerned) {
  make_character();
  const std::string model = path("in.model"), motion = path("in.anim"), out = path("out.glb");
  const ToolRun late =
      run_tool("krok-skin", {model, motion, "--as", "pose", "--time", "9s", "-o", out});
  EXPECT_EQ(late.exit_code, 2);
  EXPECT_NE(late.err.find("in.anim: error: --time 9s"), std::string::npos) << late.err;
  const ToolRun unit = run_tool("krok-diff", {motion, motion, "--tolerance", "1deg"});
  EXPECT_NE(unit.err.find("--tolerance: "), std::string::npos) << unit.err;
  const ToolRun unwritable = run_tool("krok-import", {path("in.bvh"), "-o", "/proc/out.anim"});
  EXPECT_EQ(unwritable.exit_code, 2);
  EXPECT_EQ(unwritable.err.find("does not exist"), std::string::npos) << unwritable.err;
}

TEST_F(ReportAndFiles, ReportsTellWhatWasWritten) {
  make_character();
  const ToolRun skin = run_tool("krok-skin", {path("in.model"), path("in.anim"), "--as", "rig",
                                              "-o", path("out.glb"), "--json"});
  const Json rig = Json::parse(skin.out);
  EXPECT_EQ(rig["options"]["as"], "rig");
  EXPECT_EQ(rig["result"]["frames"], 5);
  EXPECT_GT(rig["result"]["vertices"], 1000);
  const ToolRun table = run_tool("krok-export", {path("in.anim"), "-o", path("out.csv"), "--json"});
  EXPECT_EQ(Json::parse(table.out)["result"]["joints"], 4);
}

// The report is one of the set: without it a script would take an output for one that was refused.
TEST_F(ReportAndFiles, AReportThatCannotBeWrittenLeavesAllAsItWas) {
  put("out.anim", "old");
  const ToolRun full =
      run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "--save-model",
                               path("out.model"), "--json=/dev/full"});
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_NE(full.err.find("nothing was changed"), std::string::npos) << full.err;
  EXPECT_EQ(full.err.find("->"), std::string::npos) << "says that it wrote: " << full.err;
  EXPECT_EQ(get(path("out.anim")), "old");
  EXPECT_EQ(listing(), (Names{"in.bvh", "out.anim"}));
  // Of a batch, where each file is written as it is done.
  const ToolRun batch =
      run_tool("krok-import", {path("in.bvh"), "--out-dir", path("out"), "--json=/dev/full"});
  EXPECT_EQ(batch.exit_code, 2);
  EXPECT_EQ(batch.err.find("nothing was changed"), std::string::npos) << batch.err;
  EXPECT_NE(batch.err.find("the outputs were written"), std::string::npos) << batch.err;
}

}  // namespace
}  // namespace krok::test
