// If these fail, a step that is not what was asked for is taken for it, or a library does not tell
// how good it is.

#include "cli/step_library/library_fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;

// Planted steps are still what was asked for, and their feet do not drift.
TEST_F(StepLibrary, PlantedStepsAreAsAsked) {
  fit_well();
  const json made =
      synthesised({"--set", "length=57cm", "--set", "height=3cm", "--plant", "--correct"});
  EXPECT_LE(made[0]["planted"]["drift"].get<double>(), 1e-3);
  EXPECT_LE(made[0]["planted"]["drift"], made[0]["planted"]["drift_before"]);
  EXPECT_NEAR(made[0]["measured"]["length"].get<double>(), 0.57, 1e-3);
  EXPECT_NEAR(made[0]["measured"]["height"].get<double>(), 0.03, 1e-3);
}

TEST_F(StepLibrary, WhatIsNotAsAskedIsTold) {
  write("library.json", R"({"schema": "krok.library/1", "steps": "auto",
 "parameters": [{"name": "length", "measures": "step.length", "tolerance": "0.005mm"},
                {"measures": "step.height"}], "examples": [{"clip": "walk_*.bvh"}]})");
  ASSERT_EQ(fit({"--refine", "0"}).exit_code, 0);
  std::vector<std::string> set = {"--set", "length=57cm", "--set", "height=3cm"};
  const ToolRun plain = synth(set);
  EXPECT_EQ(plain.exit_code, 0);
  EXPECT_TRUE(has_code(plain.err, "synth-missed")) << plain.err;
  EXPECT_THAT(plain.err, HasSubstr("was asked for"));
  EXPECT_THAT(plain.err, HasSubstr("--correct"));
  set.emplace_back("--strict");
  EXPECT_EQ(synth(set).exit_code, 1);
  EXPECT_THAT(listing(), Contains("step.anim"));
  set.emplace_back("--correct");
  const ToolRun corrected = synth(set);
  EXPECT_EQ(corrected.exit_code, 0);
  EXPECT_FALSE(has_code(corrected.err, "synth-missed")) << corrected.err;
}

TEST_F(StepLibrary, DurationsAreExact) {
  write("library.json", R"({"schema": "krok.library/1", "steps": "auto",
 "parameters": [{"measures": "duration"}], "examples": [{"clip": "walk_*.bvh"}]})");
  const ToolRun run = fit();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json made = synthesised({"--set", "duration=0.5731s", "--correct", "--strict"});
  EXPECT_NEAR(made[0]["duration"].get<double>(), 0.5731, 1e-5);
  EXPECT_NEAR(made[0]["measured"]["duration"].get<double>(), 0.5731, 1e-5);
  const ToolRun rounded =
      synth({"--set", "duration=0.5731s", "--correct", "--strict", "--rate", "60"});
  EXPECT_EQ(rounded.exit_code, 1);
  EXPECT_TRUE(has_code(rounded.err, "synth-missed")) << rounded.err;
}

TEST_F(StepLibrary, CellsOfATableMayHaveUnits) {
  for (const char* turn : {"0", "20"}) {
    ASSERT_EQ(run({test::make_walk(), "--steps", "4", "--turn", std::string(turn) + "deg", "-q",
                   "-o", path(std::string("bend_") + turn + ".bvh")})
                  .exit_code,
              0);
  }
  write("library.json", R"({"schema": "krok.library/1", "steps": "auto",
 "parameters": [{"name": "turn", "measures": "step.turn"}], "examples": [{"clip": "bend_*.bvh"}]})");
  ASSERT_EQ(fit().exit_code, 0);
  write("points.csv", "turn [deg]\n16\n16\u00B0\n16deg\n0.279253rad\n");
  const json made = synthesised({"--points", path("points.csv"), "-o", path("s.anim")});
  ASSERT_EQ(made.size(), 4u);
  for (const json& one : made) EXPECT_NEAR(one["asked"]["turn"].get<double>(), 16, 1e-4);
  write("points.csv", "turn [deg]\n8\n8cm\n");
  const ToolRun wrong = synth({"--points", path("points.csv"), "-o", path("s.anim")});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("points.csv:3:1: error")) << wrong.err;
}

TEST_F(StepLibrary, AnInfoTellsHowGoodItIs) {
  fit_well({"--refine", "6", "--json=" + path("r.json")});
  const ToolRun text = run_tool("krok-info", {path("out.steps")});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_LT(text.out.find("held-out"), text.out.find("krok-fit"));
  // The four examples are the corners: none lies between the others.
  for (const char* says : {"length: ", "weights from ", "left out    not measured"}) {
    EXPECT_THAT(text.out, HasSubstr(says));
  }
  const ToolRun info = run_tool("krok-info", {path("out.steps"), "--json"});
  const json fit = json::parse(info.out)["result"]["files"][0]["fit"];
  const json report = json::parse(InputFile::open(path("r.json"))->text())["result"];
  EXPECT_TRUE(fit["left_out"].is_null() && report["leave_one_out"]["weighted"].is_null());
  EXPECT_LE(fit["errors"]["length"]["mean"], fit["errors"]["length"]["largest"]);
  EXPECT_LT(fit["least_weight"], fit["largest_weight"]);
}

}  // namespace
}  // namespace krok::test
