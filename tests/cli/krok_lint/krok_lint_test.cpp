// If these fail, krok-lint answers scripts and CI wrongly: exit codes, formats, what is left out.

#include <gmock/gmock.h>

#include <filesystem>

#include "cli/motion_fixture.h"
#include "core/index.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "motion/sample.h"
#include "support/glb_builder.h"

namespace krok::lint_test {
namespace {

using namespace test;

using testing::HasSubstr;
using testing::Not;

class KrokLint : public MotionTest {
 protected:
  // A walk whose left forearm jumps away and back at 2 s.
  Clip write_spiked(const std::string& name) const {
    Clip clip = write_walk(8);
    LocalMotion local = local_motion(clip);
    auto turns = local.joint_orientations(clip.skeleton.find("LeftForeArm"));
    turns[120] = turns[120] * from_rotation_vector(Vec3(0, 0.5, 0.2));
    set_local_motion(local, clip);
    write(name, clip);
    return clip;
  }
  void write_text(const std::string& name, const std::string& text) const {
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file.ok() && file->write(text).ok() && file->commit().ok());
  }
  std::string text_of(const std::string& name) const {
    return std::string(InputFile::open(path(name))->text());
  }
};

TEST_F(KrokLint, ExitCodesTellCleanFaultyUnreadableAndPartly) {
  write_walk(8);
  EXPECT_EQ(run_here("krok-lint", {"walk.anim"}).exit_code, 0);
  write_spiked("spiked.anim");
  const ToolRun faulty =
      run_here("krok-lint", {"walk.anim", "spiked.anim", "--ignore", "duplicate"});
  EXPECT_EQ(faulty.exit_code, 1);
  EXPECT_THAT(faulty.out, HasSubstr("spiked.anim: 2.00 s: error: LeftForeArm, spike: "));
  EXPECT_THAT(faulty.out, HasSubstr("[pop]"));
  EXPECT_THAT(faulty.err, HasSubstr("2 files, 1 with faults: 1 error, 0 warnings"));
  write_text("broken.bvh", "HIERARCHY\nROOT");
  EXPECT_EQ(run_here("krok-lint", {"broken.bvh"}).exit_code, 2);
  const ToolRun partly = run_here("krok-lint", {"walk.anim", "broken.bvh"});
  EXPECT_EQ(partly.exit_code, 3);
  EXPECT_THAT(partly.out, HasSubstr("[unreadable]"));
  EXPECT_EQ(run_here("krok-lint", {}).exit_code, 2);
}

// Feet of a motion in place slide backwards. One by krok-edit says how fast it travels; of another
// program's the slide leads to --treadmill.
TEST_F(KrokLint, MotionsInPlaceAreNoSlides) {
  write_walk(8);
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--treadmill", "-o", "place.anim"}).exit_code, 0);
  const ToolRun own = run_here("krok-lint", {"place.anim", "--only", "foot-slide"});
  EXPECT_EQ(own.exit_code, 0) << own.out;
  ASSERT_EQ(run_here("krok-export", {"place.anim", "-o", "place.bvh"}).exit_code, 0);
  const ToolRun other = run_here("krok-lint", {"place.bvh", "--only", "foot-slide"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.out, HasSubstr("--treadmill if the ground moves"));
  EXPECT_EQ(run_here("krok-lint", {"place.bvh", "--only", "foot-slide", "--treadmill"}).exit_code,
            0);
}

TEST_F(KrokLint, RulesAreChosen) {
  write_spiked("spiked.anim");
  EXPECT_EQ(run_here("krok-lint", {"spiked.anim", "--ignore", "pop"}).exit_code, 0);
  EXPECT_EQ(run_here("krok-lint", {"spiked.anim", "--only", "flip"}).exit_code, 0);
  EXPECT_EQ(run_here("krok-lint", {"--only", "pop", "spiked.anim"}).exit_code, 1);
  const ToolRun unknown = run_here("krok-lint", {"spiked.anim", "--only", "popp"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean"));
  write_text("loose.json",
             R"({"schema": "krok.lint-profile/1", "rules": [{"rule": "pop", "limit": 60}]})");
  EXPECT_EQ(run_here("krok-lint", {"spiked.anim", "--profile", "loose.json"}).exit_code, 0);
  write_text("wrong.json", R"({"schema": "krok.lint-profile/1", "rules": [{"rule": "plop"}]})");
  EXPECT_THAT(run_here("krok-lint", {"spiked.anim", "--profile", "wrong.json"}).err,
              HasSubstr("'plop' is no rule"));
}

TEST_F(KrokLint, SuppressionsNeedAReason) {
  write_spiked("spiked.anim");
  write_text("spiked.lint.json", R"({"schema": "krok.lint-suppressions/1", "suppressions": [
    {"rule": "pop", "from": 1.9, "to": 2.1, "reason": "the actor flinches"}]})");
  const ToolRun run = run_here("krok-lint", {"spiked.anim"});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_THAT(run.err, HasSubstr("1 suppressed"));
  write_text("spiked.lint.json", R"({"schema": "krok.lint-suppressions/1", "suppressions": [
    {"rule": "pop", "reason": " "}]})");
  const ToolRun without = run_here("krok-lint", {"spiked.anim"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.out, HasSubstr("reason"));
}

TEST_F(KrokLint, BaselinesHoldUnderExportResamplingAndUnits) {
  write_spiked("spiked.anim");
  ASSERT_EQ(run_here("krok-lint", {"spiked.anim", "--save-baseline", "known.json"}).exit_code, 1);
  std::filesystem::create_directory(path("other"));
  ASSERT_EQ(run_here("krok-export", {"spiked.anim", "-o", "other/spiked.bvh"}).exit_code, 0);
  const ToolRun exported = run_here("krok-lint", {"other/spiked.bvh", "--baseline", "known.json"});
  EXPECT_EQ(exported.exit_code, 0) << exported.out;
  EXPECT_THAT(exported.err, HasSubstr("1 known"));
  // A new fault fails.
  write_spiked("new.anim");
  const ToolRun fresh = run_here("krok-lint", {"new.anim", "--baseline", "known.json", "--json"});
  EXPECT_EQ(fresh.exit_code, 1);
  // Unless it is hardly over its limit, as what was hardly under it is at another rate.
  const json value = json::parse(fresh.out)["result"]["files"][0]["faults"][0]["value"];
  for (const double times : {1.1, 1.3}) {
    const json rule = {{"rule", "pop"}, {"limit", value.get<double>() / times}};
    write_text("profile.json", json({{"schema", "krok.lint-profile/1"}, {"rules", {rule}}}).dump());
    std::vector<std::string> arguments = {"new.anim", "--profile", "profile.json"};
    EXPECT_EQ(run_here("krok-lint", arguments).exit_code, 1);
    arguments.insert(arguments.end(), {"--baseline", "known.json"});
    EXPECT_EQ(run_here("krok-lint", arguments).exit_code, times > 1.15 ? 1 : 0) << times;
  }
}

// Would fail if what is nearly a fault, and a little over its limit in a copy at another rate, were
// a new fault; one that was far below is.
TEST_F(KrokLint, BaselinesKnowWhatIsNearlyAFault) {
  Clip clip = write_walk(8);
  LocalMotion local = local_motion(clip);
  for (Vec3& place : local.joint_positions(0)) place.x() = place.z() = 0;
  set_local_motion(local, clip);
  write("slow.anim", clip);
  const ToolRun all = run_here("krok-lint", {"slow.anim", "--only", "foot-slide", "--json"});
  const json report = json::parse(all.out);
  const double slide = report["result"]["files"][0]["faults"][0]["value"].get<double>();
  const auto lint = [&](double limit, const std::string& option) {
    const json rule = {{"rule", "foot-slide"}, {"limit", limit}};
    write_text("limit.json", json({{"schema", "krok.lint-profile/1"}, {"rules", {rule}}}).dump());
    return run_here("krok-lint", {"slow.anim", "--only", "foot-slide", "--profile", "limit.json",
                                  option, "known.json"})
        .exit_code;
  };
  for (const double times : {1.2, 2.0}) {
    ASSERT_EQ(lint(times * slide, "--save-baseline"), 0);
    EXPECT_EQ(lint(slide / 1.3, "--baseline"), times < 1.5 ? 0 : 1) << times;
    EXPECT_EQ(lint(slide / 2.2, "--baseline"), 1) << times;
  }
}

TEST_F(KrokLint, ReportsAreWhatOtherProgramsRead) {
  write_spiked("spi ked.anim");
  write_text("broken.bvh", "HIERARCHY\nROOT");
  const ToolRun run = run_here(
      "krok-lint", {"spi ked.anim", "walk.anim", "broken.bvh", "--sarif", "out.sarif", "--junit",
                    "out.xml", "--table", "out.csv", "--json", "--ignore", "duplicate"});
  EXPECT_EQ(run.exit_code, 3);
  const json report = json::parse(run.out)["result"];
  EXPECT_EQ(report["errors"], 1);
  EXPECT_EQ(report["unreadable"], 1);
  const json sarif = json::parse(text_of("out.sarif"));
  EXPECT_EQ(sarif["version"], "2.1.0");
  const json& results = sarif["runs"][0]["results"];
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0]["ruleId"], "unreadable");
  EXPECT_EQ(results[1]["ruleId"], "pop");
  EXPECT_EQ(results[1]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"],
            "spi%20ked.anim");
  EXPECT_EQ(results[1]["partialFingerprints"]["krokLint/v1"],
            report["files"][1]["faults"][0]["fingerprint"]);
  const std::string junit = text_of("out.xml");
  EXPECT_THAT(junit, HasSubstr("failures=\"1\" errors=\"1\""));
  EXPECT_THAT(junit, HasSubstr("name=\"pop\"><failure type=\"error\""));
  // A rule that did not run would be green.
  EXPECT_THAT(junit, HasSubstr("name=\"duplicate\"><skipped"));
  EXPECT_THAT(text_of("out.csv"), HasSubstr("spi ked.anim,,pop,spike,error,2,120,LeftForeArm,1,"));
}

// Trials of several steps have "Cycle" in their names, and were blamed for a seam that they lack.
TEST_F(KrokLint, LongTakesCalledCyclesAreNoLoops) {
  const Clip trial = cut(write_walk(8), 60, 225);
  ASSERT_GT(trial.duration(), 2.5);
  write("A1_Cycle1.anim", trial);
  EXPECT_THAT(run_here("krok-lint", {"A1_Cycle1.anim", "--only", "loop-seam"}).out,
              Not(HasSubstr("loop-seam")));
  EXPECT_THAT(run_here("krok-lint", {"A1_Cycle1.anim", "--only", "loop-seam", "--loops"}).out,
              HasSubstr("loop-seam"));
}

// Would fail if repairs were kept that mend nothing: here a small spike, which is no fault, beside
// a step, which no repair mends.
TEST_F(KrokLint, RepairsAfterWhichNoFewerFaultsAreLeftAreLeftOut) {
  write_spiked("spiked.anim");
  const ToolRun mended = run_here("krok-lint", {"spiked.anim", "--fix", "mended"});
  EXPECT_THAT(mended.err, HasSubstr("1 spike removed; 0 faults left of 1"));
  EXPECT_EQ(run_here("krok-lint", {"mended/spiked.anim"}).exit_code, 0);
  Clip clip = write_walk(8);
  LocalMotion local = local_motion(clip);
  auto head = local.joint_orientations(clip.skeleton.find("Head"));
  head[120] = head[120] * from_rotation_vector(Vec3(0, 0.06, 0));
  for (Quat& turn : head.subspan(200)) turn = turn * from_rotation_vector(Vec3(0, 0.5, 0.2));
  set_local_motion(local, clip);
  write("step.anim", clip);
  const ToolRun run = run_here("krok-lint", {"step.anim", "--fix", "other"});
  EXPECT_THAT(run.err, HasSubstr("step.anim: nothing mended; left out: 1 spike removed: 1 fault of "
                                 "1 would be left"));
  EXPECT_FALSE(std::filesystem::exists(path("other/step.anim")));
}

// Would fail if readers that mend weights kept the fault from krok-lint, if files without a motion
// were unreadable, or if a mesh had its faults at a time.
TEST_F(KrokLint, MeshesAreJudgedWithOrWithoutAMotion) {
  const auto put_glb = [&](const std::string& name, const GlbBuilder& builder) {
    const auto bytes = builder.glb();
    write_text(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  };
  put_glb("clean.glb", square());
  EXPECT_EQ(run_here("krok-lint", {"clean.glb"}).exit_code, 0);
  GlbBuilder rigged = rig();
  auto& primitive = rigged.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["WEIGHTS_0"] =
      rigged.add(std::vector<float>{0, 0, 0, 0, .5F, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  put_glb("rigged.glb", rigged);
  const ToolRun weights = run_here("krok-lint", {"rigged.glb", "--ignore", "loop-seam"});
  EXPECT_EQ(weights.exit_code, 1);
  EXPECT_THAT(weights.out, HasSubstr("rigged.glb: error: mesh 0 (Square), primitive 0: 1 vert"));
  EXPECT_THAT(weights.out, HasSubstr("[unweighted-vertex]"));
  EXPECT_THAT(weights.out, HasSubstr("sum to 0.5 to 0.5 instead of 1"));
  GlbBuilder still = square();
  still.json["meshes"][0]["primitives"][0]["indices"] =
      still.add(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3, 3, 3, 1}, "SCALAR");
  put_glb("still.glb", still);
  const std::vector<std::string> in = {"still.glb", "--only", "degenerate-triangle"};
  const ToolRun scene = run_here("krok-lint", in);
  EXPECT_THAT(scene.out, HasSubstr("still.glb: warning: mesh 0 (Square), primitive 0: 33.3 %, "
                                   "limit 0.5 % (1 with a vertex twice"));
  ASSERT_EQ(run_here("krok-import", {"rigged.glb", "--save-character", "hero.character"}).exit_code,
            0);
  const ToolRun models = run_here("krok-lint", {"hero.character", "hero.model"});
  EXPECT_EQ(models.exit_code, 0) << models.out;
}

// Would fail if one of a file's animations were judged for all, or mended for another.
TEST_F(KrokLint, EachAnimationOfAFileIsJudged) {
  write_spiked("spiked.anim");
  ASSERT_EQ(run_here("krok-body", {"walk.anim", "-o", "body.model"}).exit_code, 0);
  ASSERT_EQ(
      run_here("krok-skin", {"body.model", "walk.anim", "spiked.anim", "-o", "both.glb"}).exit_code,
      0);
  const std::string pop = "both.glb: spiked: 2.00 s: error: LeftForeArm, spike";
  const ToolRun run = run_here(
      "krok-lint", {"both.glb", "--only", "pop", "--table", "t.csv", "--save-baseline",
                    "known.json", "--fix", "mended", "--html", "t.html", "--save-pages", "pages"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(run.out, StartsWith(pop));
  EXPECT_THAT(run.out, Not(HasSubstr("both.glb: walk:")));
  EXPECT_THAT(run.err, HasSubstr("1 file with 2 animations, 1 with faults"));
  EXPECT_THAT(text_of("t.csv"), HasSubstr("both.glb,spiked,pop,"));
  EXPECT_THAT(text_of("t.html"), HasSubstr("href=\"pages/both_spiked.html#t=2.0000"));
  EXPECT_EQ(run_here("krok-lint", {"mended/both_spiked.anim", "--only", "pop"}).exit_code, 0);
  const std::vector<std::string> known = {"both.glb", "--only", "pop", "--baseline", "known.json"};
  EXPECT_EQ(run_here("krok-lint", known).exit_code, 0);
  const ToolRun same = run_here("krok-lint", {"both.glb", "walk.anim", "--only", "duplicate"});
  EXPECT_THAT(same.out, HasSubstr("walk.anim: 0.00 s: warning: body: the same motion as both.glb: "
                                  "walk [duplicate]"));
}

// Would fail if each animation of a file that is named for its loops were one.
TEST_F(KrokLint, APackOfLoopsHasOtherAnimations) {
  write_walk(8);
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--to", "2.3s", "-o", "cut.anim"}).exit_code, 0);
  ASSERT_EQ(run_here("krok-body", {"walk.anim", "-o", "body.model"}).exit_code, 0);
  ASSERT_EQ(
      run_here("krok-skin", {"body.model", "walk.anim", "cut.anim", "-o", "loops.glb"}).exit_code,
      0);
  EXPECT_EQ(run_here("krok-lint", {"loops.glb", "--only", "loop-seam"}).exit_code, 0);
  EXPECT_EQ(run_here("krok-lint", {"loops.glb", "--only", "loop-seam", "--loops"}).exit_code, 1);
}

// Would fail if a file with an animation for each joint were as many motions of one joint.
TEST_F(KrokLint, AnAnimationForEachJointIsNoMotion) {
  write_walk(8);
  ASSERT_EQ(run_here("krok-export", {"walk.anim", "-o", "split.gltf"}).exit_code, 0);
  json file = json::parse(get(path("split.gltf")));
  const json whole = file["animations"][0];
  file["animations"] = json::array();
  for (const json& channel : whole["channels"]) {
    json one = whole;
    one["channels"] = json::array({channel});
    file["animations"].push_back(one);
  }
  put("split.gltf", file.dump());
  const ToolRun run = run_here("krok-lint", {"split.gltf", "--only", "duplicate"});
  EXPECT_THAT(run.err, HasSubstr("1 file, 0 with faults"));
}

// Would fail if the slow rule ran unasked, or were not found by its option.
TEST_F(KrokLint, SelfIntersectionIsAskedFor) {
  Clip clip = write_walk(8);
  LocalMotion local = local_motion(clip);
  for (Quat& one : local.joint_orientations(clip.skeleton.find("LeftUpLeg")).subspan(100, 50)) {
    one = from_rotation_vector(Vec3(0, 0, -0.25)) * one;
  }
  set_local_motion(local, clip);
  write("crossed.anim", clip);
  EXPECT_THAT(run_here("krok-lint", {"crossed.anim"}).out, Not(HasSubstr("self-intersection")));
  EXPECT_THAT(run_here("krok-lint", {"crossed.anim", "--self-intersection"}).out,
              HasSubstr("[self-intersection]"));
  EXPECT_EQ(run_here("krok-lint", {"walk.anim", "--only", "self-intersection"}).exit_code, 0);
}

// Would fail if a row of the page did not lead to its moment and joint in a page that is there.
TEST_F(KrokLint, RowsOfThePageOpenTheirMoment) {
  const Clip clip = write_spiked("spi ked.anim");
  std::filesystem::create_directory(path("report"));
  const ToolRun run =
      run_here("krok-lint", {"spi ked.anim", "walk.anim", "--ignore", "duplicate", "--html",
                             "report/faults.html", "--save-pages", "pages"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(text_of("report/faults.html"),
              HasSubstr("<a href=\"../pages/spi%20ked.html#t=2.0000&amp;joint=0," +
                        std::to_string(clip.skeleton.find("LeftForeArm")) + "\">2.00 s</a>"));
  EXPECT_THAT(text_of("pages/spi ked.html"), HasSubstr("\"spi ked"));
  EXPECT_FALSE(std::filesystem::exists(path("pages/walk.html")));
  EXPECT_EQ(run_here("krok-lint", {"walk.anim", "--save-pages", "pages"}).exit_code, 2);
}

TEST_F(KrokLint, AnyNumberOfThreadsGivesTheSame) {
  write_spiked("spiked.anim");
  const std::vector<std::string> inputs = {"walk.anim", "spiked.anim", "walk.anim"};
  std::vector<std::string> one = inputs, three = inputs;
  one.insert(one.end(), {"-j", "1", "--json"});
  three.insert(three.end(), {"-j", "3", "--json"});
  EXPECT_EQ(run_here("krok-lint", one).out, run_here("krok-lint", three).out);
}

}  // namespace
}  // namespace krok::lint_test
