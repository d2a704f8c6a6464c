// If these fail, krok-import or krok-info takes an Acclaim motion without its skeleton or with a
// wrong one, or leaves the user without a word on what to do.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/krok_import/imported.h"
#include "unit/acclaim/small_files.h"

namespace krok::test {
namespace {

using PlainJson = nlohmann::json;

class AcclaimImport : public CliTest {
 protected:
  Clip imported(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--unit", "m", "--up", "y", "--forward", "z"});
    return imported_clip(std::move(arguments), path("out.anim"));
  }
};

TEST_F(AcclaimImport, AMotionWithItsSkeleton) {
  put("leg.asf", small_files::kAsf);
  put("walk.amc", small_files::kAmc);
  put("other.asf", "not this one");
  const Clip clip = imported({path("walk.amc"), "--skeleton", path("leg.asf")});
  EXPECT_EQ(clip.frame_count(), 3);
  EXPECT_EQ(clip.rate, 120.0);
  EXPECT_EQ(clip.skeleton.names[0], "root");
  EXPECT_EQ(clip.positions[0], Vec3f(0, 9, 0));
  ASSERT_EQ(clip.provenance.sources.size(), 2u);
  EXPECT_EQ(clip.provenance.sources[0].name, "walk.amc");
  EXPECT_EQ(clip.provenance.sources[1].name, "leg.asf");
}

TEST_F(AcclaimImport, ASkeletonAloneHasNoFrames) {
  put("leg.asf", small_files::kAsf);
  const Clip clip = imported({path("leg.asf"), "--save-model", path("leg.model")});
  EXPECT_EQ(clip.frame_count(), 0);
  EXPECT_EQ(clip.skeleton.reference[2].position, Vec3(0, -4, 0));
  EXPECT_TRUE(std::filesystem::exists(path("leg.model")));
}

// Would fail if a motion on another person's skeleton were a slip that nobody sees.
TEST_F(AcclaimImport, AnotherSkeletonThanItsOwnIsWarnedOf) {
  put("01.asf", small_files::kAsf);
  put("02.asf", small_files::kAsf);
  put("01_03.amc", small_files::kAmc);
  const auto warned = [&](const char* skeleton) {
    const ToolRun run = run_tool(
        "krok-import", {path("01_03.amc"), "--skeleton", path(skeleton), "-o", path("o.anim")});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return has_code(run.err, "acclaim-skeleton");
  };
  EXPECT_TRUE(warned("02.asf"));
  EXPECT_FALSE(warned("01.asf"));
}

TEST_F(AcclaimImport, TheSkeletonBesideIsFoundAndNamed) {
  put("01.asf", small_files::kAsf);
  put("02.asf", small_files::kAsf);
  put("01_03.amc", small_files::kAmc);
  const ToolRun run =
      run_tool("krok-import", {path("01_03.amc"), "-o", path("out.anim"), "-v", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("01.asf is used as the skeleton"));
  EXPECT_TRUE(has_code(run.err, "acclaim-skeleton"));
  const PlainJson report = PlainJson::parse(run.out);
  EXPECT_EQ(report["result"]["frames"], 3);
  EXPECT_EQ(report["result"]["first_frame_number"], 1);
  EXPECT_EQ(report["inputs"].size(), 2u);
}

TEST_F(AcclaimImport, WithoutASkeletonItSaysWhatToDo) {
  put("walk.amc", small_files::kAmc);
  for (const char* name : {"", "a.asf", "b.asf"}) {
    if (*name != '\0') put(name, small_files::kAsf);
    if (std::string(name) == "a.asf") continue;  // the only one is taken
    const ToolRun run = run_tool("krok-import", {path("walk.amc"), "-o", path("out.anim")});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(has_code(run.err, "acclaim-skeleton")) << run.err;
    EXPECT_THAT(run.err, HasSubstr("--skeleton"));
    EXPECT_FALSE(std::filesystem::exists(path("out.anim")));
  }
}

TEST_F(AcclaimImport, OptionsThatDoNotFitAreUsageErrors) {
  put("in.bvh", capture(3));
  put("leg.asf", small_files::kAsf);
  put("walk.amc", small_files::kAmc);
  const std::vector<std::vector<std::string>> cases = {
      {path("in.bvh"), "--skeleton", path("leg.asf")},
      {path("leg.asf"), "--skeleton", path("leg.asf")},
      {path("walk.amc"), "--positions", "absolute"},
      {path("walk.amc"), "--angles", "radians"}};
  for (std::vector<std::string> arguments : cases) {
    const std::string option = arguments[1];
    arguments.insert(arguments.end(), {"-o", path("out.anim")});
    const ToolRun run = run_tool("krok-import", arguments);
    EXPECT_EQ(run.exit_code, 2) << option;
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
    EXPECT_THAT(run.err, HasSubstr(option));
  }
}

TEST_F(AcclaimImport, TheFirstFrameIsLeftOutWhereAsked) {
  put("leg.asf", small_files::kAsf);
  put("walk.amc", small_files::kAmc);
  const ToolRun run = run_tool("krok-import", {path("walk.amc"), "--skip-rest-frame", "yes", "-o",
                                               path("out.anim"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const PlainJson result = PlainJson::parse(run.out)["result"];
  EXPECT_EQ(result["frames"], 2);
  EXPECT_EQ(result["first_frame_number"], 2);
  EXPECT_EQ(result["rest_frame"]["left_out"], true);
}

TEST_F(AcclaimImport, TwoFilesInTheWrongPlaces) {
  put("leg.asf", small_files::kAsf);
  put("walk.amc", small_files::kAmc);
  put("in.bvh", capture(3));
  for (const char* wrong : {"walk.amc", "in.bvh"}) {
    const ToolRun run = run_tool(
        "krok-import", {path("walk.amc"), "--skeleton", path(wrong), "-o", path("out.anim")});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(has_code(run.err, "acclaim-kind")) << run.err;
    EXPECT_THAT(run.err, HasSubstr(wrong));
  }
}

TEST_F(AcclaimImport, InfoReadsBoth) {
  put("leg.asf", small_files::kAsf);
  put("leg_1.amc", small_files::kAmc);
  const ToolRun run = run_tool("krok-info", {path("leg.asf"), path("leg_1.amc"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const PlainJson files = PlainJson::parse(run.out)["result"]["files"];
  EXPECT_EQ(files[0]["kind"], "asf");
  EXPECT_FALSE(files[0].contains("frames"));
  EXPECT_EQ(files[1]["kind"], "amc");
  EXPECT_EQ(files[1]["frames"], 3);
  EXPECT_EQ(files[1]["rate"], 120.0);
  EXPECT_EQ(files[0]["joints"], files[1]["joints"]);
  std::filesystem::remove(path("leg.asf"));
  const ToolRun alone = run_tool("krok-info", {path("leg_1.amc")});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_TRUE(has_code(alone.err, "acclaim-skeleton")) << alone.err;
  EXPECT_THAT(alone.err, Not(HasSubstr("--skeleton")));
}

// A batch that runs again must not keep a result that a single run would not make.
TEST_F(AcclaimImport, ASkeletonThatCameLaterIsTakenByABatch) {
  std::filesystem::create_directory(path("in"));
  put("in/walk.amc", small_files::kAmc);
  put("in/other.asf", small_files::kAsf);
  const std::vector<std::string> batch = {path("in"), "--out-dir", path("out"), "--json"};
  const auto status = [&] {
    const PlainJson report = PlainJson::parse(run_tool("krok-import", batch).out);
    const auto& file = report["files"][0];
    return file["status"].get<std::string>() + " " +
           base_name(file["inputs"][1]["path"].get<std::string>());
  };
  EXPECT_EQ(status(), "done other.asf");
  EXPECT_EQ(status(), "unchanged other.asf");
  put("in/notes.txt", "no skeleton");
  EXPECT_EQ(status(), "unchanged other.asf");
  put("in/walk.asf", small_files::kAsf);
  EXPECT_EQ(status(), "done walk.asf");
  EXPECT_EQ(status(), "unchanged walk.asf");
}

}  // namespace
}  // namespace krok::test
