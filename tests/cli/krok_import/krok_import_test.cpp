// If these fail, krok-import takes its options wrongly, hides its choices, or leaves one of two
// outputs behind when the other fails.

#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/krok_import/imported.h"
#include "formats/model/model_format.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using PlainJson = nlohmann::json;
const std::string kWalk = source_folder() + "/samples/captures/walk.bvh";
using testing::HasSubstr;
using testing::Not;

class ImportTest : public CliTest {
 protected:
  Clip imported(const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {path("in.bvh")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return imported_clip(std::move(arguments), path("out.anim"));
  }
};

TEST_F(ImportTest, AxesMayBeginWithAMinus) {
  put("in.bvh", capture(5));
  const Clip apart = imported({"--unit", "m", "--up", "-x", "--forward", "y"});
  const Clip joined = imported({"--unit=m", "--up=-x", "--forward=y"});
  EXPECT_EQ(apart.positions, joined.positions);
  // The root stands at y = 1 in the file, which is forward.
  EXPECT_EQ(apart.positions[0], Vec3f(0, 0, 1));
}

TEST_F(ImportTest, NumbersPassThroughUnconverted) {
  put("in.bvh", capture(5));
  const Clip clip = imported({"--unit", "m", "--up", "y", "--forward", "z"});
  EXPECT_EQ(clip.positions[0], Vec3f(0, 1, 0));
  EXPECT_TRUE(clip.provenance.conversions.empty());
  EXPECT_EQ(clip.provenance.sources.at(0).name, "in.bvh");
  const Clip feet = imported({"--unit", "ft", "--up", "y", "--forward", "z"});
  EXPECT_EQ(feet.positions[0], Vec3f(0, 0.3048f, 0));
  EXPECT_EQ(feet.provenance.conversions.size(), 1u);
}

TEST_F(ImportTest, RatesAreTakenAndResampled) {
  put("in.bvh", capture(11));
  EXPECT_EQ(imported({}).rate, 30.0);
  const Clip faster = imported({"--fps", "60"});
  EXPECT_EQ(faster.rate, 60.0);
  EXPECT_EQ(faster.frame_count(), 11);
  const auto messages = [&](const std::string& option, const std::string& value) {
    return run_tool("krok-import", {path("in.bvh"), "-o", path("a.anim"), option, value}).err;
  };
  EXPECT_THAT(messages("--fps", "60"), HasSubstr("the motion is 2 times as fast"));
  EXPECT_THAT(messages("--fps", "30"), Not(HasSubstr("bvh-other-rate")));
  EXPECT_THAT(messages("--rate", "60"), Not(HasSubstr("bvh-other-rate")));
  const Clip resampled = imported({"--rate", "60"});
  EXPECT_EQ(resampled.rate, 60.0);
  EXPECT_EQ(resampled.frame_count(), 21);
  for (const std::string rate : {"0", "-5", "nan", "inf", "1e999", "30x", ""}) {
    const ToolRun run =
        run_tool("krok-import", {path("in.bvh"), "-o", path("no.anim"), "--fps", rate});
    EXPECT_EQ(run.exit_code, 2) << rate;
  }
}

// Would fail if a root in another unit than the skeleton put the body high up without a word.
TEST_F(ImportTest, ABodyHighOverTheGroundIsSaid) {
  std::istringstream text(std::string(InputFile::open(kWalk)->text()));
  std::string line, high;
  for (bool frames = false; std::getline(text, line); frames |= line.starts_with("Frame Time")) {
    std::istringstream numbers(line);
    double x = 0, y = 0, z = 0;
    if (frames && numbers >> x >> y >> z) {
      std::string rest;
      std::getline(numbers, rest);
      line = std::to_string(2.54 * x) + ' ' + std::to_string(2.54 * y) + ' ' +
             std::to_string(2.54 * z) + rest;
    }
    high += line + '\n';
  }
  put("high.bvh", high);
  const auto said = [&](const std::string& file) {
    return run_tool("krok-import", {file, "-o", path("out.anim")}).err;
  };
  EXPECT_THAT(said(path("high.bvh")), HasSubstr("motion-height"));
  EXPECT_THAT(said(kWalk), Not(HasSubstr("motion-height")));
}

// Would fail if steps were lost on the way through arrays, whose contacts come with them.
TEST_F(ImportTest, ArraysOfAWalkHaveItsSteps) {
  ASSERT_EQ(run_tool("krok-export", {kWalk, "-o", path("w.npz")}).exit_code, 0);
  ASSERT_EQ(run_tool("krok-import", {path("w.npz"), "-o", path("w.anim")}).exit_code, 0);
  const auto events = [&](const std::string& motion) {
    EXPECT_EQ(run_tool("krok-keys", {motion, "-o", path("e.csv")}).exit_code, 0);
    return std::ranges::count(InputFile::open(path("e.csv"))->text(), '\n');
  };
  EXPECT_EQ(events(path("w.anim")), events(kWalk));
  EXPECT_GT(events(kWalk), 4);
}

TEST_F(ImportTest, TheModelIsTheSkeleton) {
  put("in.bvh", capture(5));
  const Clip clip = imported({"--save-model", path("out.model")});
  const auto file = InputFile::open(path("out.model"));
  ASSERT_TRUE(file.ok());
  const auto model = model::read(file->bytes());
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ(model->skeleton.names, clip.skeleton.names);
  EXPECT_EQ(model->vertex_count(), 0);
}

TEST_F(ImportTest, BothOutputsAppearOrNone) {
  put("in.bvh", capture(5));
  for (const auto& [motion, model] :
       {std::pair<std::string, std::string>{"out.anim", "none/out.model"},
        {"none/out.anim", "out.model"},
        {"out.anim", "out.anim"}}) {
    const ToolRun run =
        run_tool("krok-import", {path("in.bvh"), "-o", path(motion), "--save-model", path(model)});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(listing(), (std::vector<std::string>{"in.bvh"}));
  }
}

TEST_F(ImportTest, TheReportTellsEveryChoice) {
  put("in.bvh", capture(5));
  const ToolRun run =
      run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "--json", "--up", "y"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const PlainJson result = PlainJson::parse(run.out)["result"];
  EXPECT_EQ(result["joints"], 4);
  EXPECT_EQ(result["frames"], 5);
  EXPECT_EQ(result["rate"], 30.0);
  EXPECT_EQ(result["up"]["choice"], "y");
  EXPECT_EQ(result["up"]["confidence"], "certain");
  EXPECT_EQ(result["up"]["reason"], "as given");
  for (const char* key : {"name", "metres", "confidence", "reason"}) {
    EXPECT_TRUE(result["unit"].contains(key)) << key;
  }
  for (const char* key : {"forward", "positions", "source_rate"}) {
    EXPECT_FALSE(result[key]["reason"].get<std::string>().empty()) << key;
  }
  EXPECT_EQ(result["repairs"], PlainJson::array());
}

TEST_F(ImportTest, GuessesAreWarnings) {
  put("in.bvh", capture(5));  // no human figure, so nothing shows its axes
  const ToolRun run = run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim")});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(has_code(run.err, "bvh-up")) << run.err;
  EXPECT_TRUE(has_code(run.err, "bvh-forward")) << run.err;
  EXPECT_EQ(run.out, "");
}

TEST_F(ImportTest, RepairsAreListed) {
  put("in.bvh", capture(5, "nan"));
  const ToolRun plain = run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim")});
  EXPECT_EQ(plain.exit_code, 2);
  EXPECT_TRUE(has_code(plain.err, "bvh-number")) << plain.err;
  const ToolRun repaired =
      run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "--repair", "--json"});
  ASSERT_EQ(repaired.exit_code, 0) << repaired.err;
  const PlainJson result = PlainJson::parse(repaired.out)["result"];
  EXPECT_EQ(result["frames"], 5);
  EXPECT_EQ(result["repairs"].size(), 1u);
  const ToolRun both =
      run_tool("krok-import", {path("in.bvh"), "-o", path("o.anim"), "--repair", "--strict"});
  EXPECT_EQ(both.exit_code, 2);
}

// The motion is streamed until such a number is met, and read anew then.
TEST_F(ImportTest, NumbersBeyondSenseAreToldOnceAndStrictRefusesThem) {
  put("in.bvh", capture(500, "8e8"));
  const ToolRun run = run_tool("krok-import", {path("in.bvh"), "-o", path("out.anim"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  int told = 0;
  const PlainJson report = PlainJson::parse(run.out);
  for (const PlainJson& issue : report["issues"]) {
    if (issue["code"] != "bvh-far-position") continue;
    ++told;
    EXPECT_EQ(issue["severity"], "warning");
    EXPECT_FALSE(issue["joint"].get<std::string>().empty());
    EXPECT_GE(issue["frame"].get<int>(), 0);
    EXPECT_GT(issue["line"].get<int>(), 0);
    EXPECT_GT(issue["column"].get<int>(), 0);
  }
  EXPECT_EQ(told, 1) << run.out;
  const ToolRun strict =
      run_tool("krok-import", {path("in.bvh"), "-o", path("no.anim"), "--strict"});
  EXPECT_EQ(strict.exit_code, 2);
  EXPECT_TRUE(has_code(strict.err, "bvh-far-position")) << strict.err;
}

TEST_F(ImportTest, OutputsNamedAfterAnotherFormatAreRefused) {
  put("in.bvh", capture(5));
  for (const std::string name : {"x.glb", "x.gltf", "x.bvh", "x.GLB"}) {
    const ToolRun run = run_tool("krok-import", {path("in.bvh"), "-o", path(name)});
    EXPECT_EQ(run.exit_code, 2) << name;
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
    EXPECT_NE(run.err.find("krok-export"), std::string::npos) << run.err;
  }
  const ToolRun model = run_tool(
      "krok-import", {path("in.bvh"), "-o", path("x.anim"), "--save-model", path("x.glb")});
  EXPECT_EQ(model.exit_code, 2);
  EXPECT_NE(model.err.find("krok-skin"), std::string::npos) << model.err;
  EXPECT_EQ(listing(), (std::vector<std::string>{"in.bvh"}));
  // A name that promises nothing is the user's choice, another ending is a mistake.
  EXPECT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("x")}).exit_code, 0);
  EXPECT_EQ(run_tool("krok-import", {path("in.bvh"), "-o", path("x.out")}).exit_code, 2);
}

TEST_F(ImportTest, WrongValuesAreUsageErrors) {
  put("in.bvh", capture(5));
  const std::vector<std::vector<std::string>> cases = {
      {"--unit", "furlong"}, {"--up", "w"},          {"--up", "z", "--forward", "-z"},
      {"--positions", "x"},  {"--orientation", "q"}, {"--skip-rest-frame", "perhaps"}};
  for (const auto& options : cases) {
    std::vector<std::string> arguments = {path("in.bvh"), "-o", path("out.anim")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ToolRun run = run_tool("krok-import", arguments);
    EXPECT_EQ(run.exit_code, 2) << options[0];
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
  }
  EXPECT_EQ(listing(), (std::vector<std::string>{"in.bvh"}));
}

// An export that lost its frames went through a batch without a word.
TEST_F(ImportTest, AFileWithoutFramesIsWarnedOf) {
  put("none.bvh", capture(0));
  put("one.bvh", capture(1));
  EXPECT_TRUE(has_code(run_here("krok-import", {"none.bvh", "-o", "a.anim"}).err, "import-empty"));
  EXPECT_FALSE(has_code(run_here("krok-import", {"one.bvh", "-o", "a.anim"}).err, "import-empty"));
}

}  // namespace
}  // namespace krok::test
