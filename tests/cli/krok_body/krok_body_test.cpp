// If these fail, krok-body leaves a script or its user in the dark: a wrong exit code, a message
// that does not help, a report without its facts, or bytes that depend on the machine.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/kept_files.h"
#include "core/file.h"
#include "formats/model/model_format.h"

namespace krok::test {
namespace {

const std::string kFrozenMotion = kFrozen + "motion.anim";

class KrokBody : public CliTest {
 protected:
  // With --detail low and -o body.model.
  ToolRun build(std::vector<std::string> arguments) const {
    for (const std::string& more :
         {std::string("--detail"), std::string("low"), std::string("-o"), path("body.model")}) {
      arguments.push_back(more);
    }
    return run_tool("krok-body", arguments);
  }
};

TEST_F(KrokBody, WritesAModelAndOneLine) {
  const ToolRun run = build({kFrozenMotion});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("body: 2,5"));
  EXPECT_THAT(run.err, HasSubstr("-> " + path("body.model")));
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_THAT(listing(), ElementsAre("body.model"));

  const auto file = InputFile::open(path("body.model"));
  ASSERT_TRUE(file.ok());
  const auto model = model::read(file->bytes());
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ(model->skeleton.joint_count(), 3);
  EXPECT_NEAR(model->vertex_count(), 2500, 100);
  EXPECT_THAT(model->provenance.conversions,
              testing::Contains(std::string("body built in pose: reference")));
}

TEST_F(KrokBody, TakesTheSkeletonOfAModelToo) {
  ASSERT_EQ(build({kFrozen + "full.model"}).exit_code, 0);
  const std::string before = get(path("body.model"));
  EXPECT_EQ(build({path("body.model")}).exit_code, 2);  // not over itself
  EXPECT_EQ(get(path("body.model")), before);
}

TEST_F(KrokBody, AMissingFile) {
  const ToolRun run = build({path("none.anim")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("none.anim: error: no such file [file-missing]"));
  EXPECT_THAT(listing(), IsEmpty());
}

TEST_F(KrokBody, ACaptureIsReadAsItIs) {
  const ToolRun run = build({put("walk.bvh", capture(3))});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(listing(), ElementsAre("body.model", "walk.bvh"));
}

TEST_F(KrokBody, FilesThatAreNoSkeletonOrDamaged) {
  std::string cut = get(kFrozenMotion);
  cut.resize(cut.size() / 2);
  const std::pair<std::string, const char*> cases[] = {
      {put("cut.anim", cut), "[container-truncated]"},
      {put("empty.anim", ""), "[container-magic]"},
      {kFrozen + "camera.cam", "[container-magic]"},
  };
  for (const auto& [file, code] : cases) {
    const ToolRun run = build({file});
    EXPECT_EQ(run.exit_code, 2) << file;
    EXPECT_THAT(run.err, HasSubstr(code));
    EXPECT_FALSE(std::filesystem::exists(path("body.model")));
  }
}

TEST_F(KrokBody, AnOutputThatCannotBeWritten) {
  const ToolRun run =
      run_tool("krok-body", {kFrozenMotion, "--detail", "low", "-o", path("no/such/body.model")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("[file-unwritable]"));
  EXPECT_THAT(run.err, HasSubstr("hint: create the folder first"));
  EXPECT_THAT(listing(), IsEmpty());

  put("body.model", "mine");
  EXPECT_EQ(build({kFrozenMotion, "--no-clobber"}).exit_code, 2);
  EXPECT_EQ(get(path("body.model")), "mine");
}

TEST_F(KrokBody, UsageErrors) {
  const std::string out = path("x.model");
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{kFrozenMotion, "--detail", "enormous", "-o", out},
       "krok-body: error: --detail: 'enormous' is not low, medium or high [usage]"},
      {{kFrozenMotion, "--pose", "soon", "-o", out},
       "--pose: 'soon' is not auto, reference or a frame number [usage]"},
      {{kFrozenMotion, "--pose", "-1", "-o", out}, "[usage]"},
      {{kFrozenMotion}, "no output given [usage]"},
      {{"-o", out}, "[usage]"},
      {{kFrozenMotion, "--nonsense", "-o", out}, "[usage]"},
  };
  for (const auto& [arguments, text] : cases) {
    const ToolRun run = run_tool("krok-body", arguments);
    EXPECT_EQ(run.exit_code, 2) << text;
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, HasSubstr(text));
  }
  EXPECT_THAT(listing(), IsEmpty());
}

TEST_F(KrokBody, AFrameThatIsNotThere) {
  const ToolRun run = build({kFrozenMotion, "--pose", "99"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("motion.anim: error: frame 99 is out of range, the clip has 2"));
  EXPECT_THAT(run.err, HasSubstr("[body-frame]"));
  EXPECT_EQ(build({kFrozenMotion, "--pose", "1"}).exit_code, 0);
}

TEST_F(KrokBody, BytesDoNotDependOnThreadsOrFolders) {
  ASSERT_EQ(build({kFrozenMotion, "-j1"}).exit_code, 0);
  const std::string one = get(path("body.model"));
  for (const char* jobs : {"-j2", "-j3", "-j0"}) {
    ASSERT_EQ(build({kFrozenMotion, jobs}).exit_code, 0);
    EXPECT_TRUE(get(path("body.model")) == one) << jobs;
  }
  std::filesystem::copy(kFrozenMotion, path("motion.anim"));
  ASSERT_EQ(build({path("motion.anim")}).exit_code, 0);
  EXPECT_TRUE(get(path("body.model")) == one);
}

TEST_F(KrokBody, JsonHoldsTheMetrics) {
  const ToolRun run = build({kFrozenMotion, "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const json report = json::parse(run.out);
  EXPECT_EQ(report["schema"], "krok.report/1");
  EXPECT_EQ(report["tool"], "krok-body");
  EXPECT_EQ(report["inputs"][0]["path"], kFrozenMotion);
  EXPECT_EQ(report["options"]["detail"], "low");
  EXPECT_EQ(report["outputs"], json{path("body.model")});
  const json& result = report["result"];
  EXPECT_NEAR(result["vertices"].get<double>(), 2500, 100);
  // A closed surface without handles.
  EXPECT_EQ(result["triangles"].get<int>(), 2 * result["vertices"].get<int>() - 4);
  EXPECT_EQ(result["joints"], 3);
  EXPECT_EQ(result["bones"], 2);
  EXPECT_GT(result["volume"].get<double>(), 0);
  EXPECT_EQ(result["human"], false);
  EXPECT_TRUE(result["stature"].is_null());
  EXPECT_EQ(result["pose"], "reference");
}

TEST_F(KrokBody, JsonTellsOfTrouble) {
  const ToolRun run = build({path("none.anim"), "--json"});
  EXPECT_EQ(run.exit_code, 2);
  const json report = json::parse(run.out);
  EXPECT_EQ(report["issues"][0]["code"], "file-missing");
  EXPECT_EQ(report["issues"][0]["severity"], "error");
}

}  // namespace
}  // namespace krok::test
