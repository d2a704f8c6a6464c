// If these fail, krok-ik --plant leaves feet sliding, plants them otherwise than krok-edit does or
// after the goals, or --plot shows something else than the report.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/motion_fixture.h"
#include "core/index.h"
#include "support/planted_measures.h"

namespace krok::test {
namespace {

class KrokIkPlant : public test::MotionTest {
 protected:
  KrokIkPlant() {
    samples::WalkOptions options;
    options.steps = 4;
    options.rate = 30;
    write("walk.anim", with_skate(samples::make_walk(options).value(), {.body_jitter = 0.001}));
  }

  test::ToolRun run(const std::string& tool, std::vector<std::string> arguments) const {
    return run_here(tool, std::move(arguments));
  }
  // Refused, with nothing written.
  void refused(std::vector<std::string> arguments, const char* says) const {
    const auto done = run("krok-ik", std::move(arguments));
    EXPECT_EQ(done.exit_code, 2) << done.err;
    EXPECT_THAT(done.err, HasSubstr(says));
    EXPECT_FALSE(std::filesystem::exists(path("x.anim")));
    EXPECT_FALSE(std::filesystem::exists(path("x.svg")));
  }

  // A hand's place in frame 30 of a motion, moved by a little.
  static Vec3 wanted(const Clip& clip) {
    return joint_of(clip, 30, clip.skeleton.find("RightHand")).position + Vec3(0, 0.1, 0.05);
  }
  static std::string reach(const Vec3& to) {
    return "RightHand=" + std::to_string(to.x()) + "m," + std::to_string(to.y()) + "m," +
           std::to_string(to.z()) + "m@30f";
  }
};

TEST_F(KrokIkPlant, AloneItIsWhatKrokEditDoes) {
  const auto edit = run("krok-edit", {"walk.anim", "--plant", "-o", "edit.anim", "--json"});
  const auto ik = run("krok-ik", {"walk.anim", "--plant", "-o", "ik.anim", "--json"});
  ASSERT_EQ(edit.exit_code, 0) << edit.err;
  ASSERT_EQ(ik.exit_code, 0) << ik.err;
  const Clip by_edit = read("edit.anim"), by_ik = read("ik.anim");
  EXPECT_EQ(by_ik.positions, by_edit.positions);
  EXPECT_NE(by_ik.positions, read("walk.anim").positions);
  const json result = json::parse(ik.out)["result"];
  const json step = json::parse(edit.out)["result"]["steps"][0];
  EXPECT_EQ(result["frames"], by_ik.frame_count());
  ASSERT_FALSE(result["plant"].empty());
  for (const auto& [key, value] : result["plant"].items()) EXPECT_EQ(value, step[key]) << key;
  EXPECT_GT(result["plant"]["drift_before"], 0.02);
  EXPECT_LT(result["plant"]["drift"], 0.0005);
  EXPECT_GE(result["plant"]["stays"].size(), 8U);
  const auto told = run("krok-ik", {"walk.anim", "--plant", "-o", "told.anim"});
  EXPECT_THAT(told.err, HasSubstr("told.anim: feet planted in "));
  EXPECT_THAT(by_ik.provenance.conversions.back(), HasSubstr("feet planted in "));
}

// Otherwise a hand is planted away from where it was sent to, or feet slide on.
TEST_F(KrokIkPlant, GoalsAreForThePlantedMotion) {
  ASSERT_EQ(run("krok-ik", {"walk.anim", "--plant", "-o", "planted.anim"}).exit_code, 0);
  const Clip planted = read("planted.anim");
  const Vec3 to = wanted(planted);
  const auto both = run("krok-ik", {"walk.anim", "--plant", "--reach", reach(to), "--fade", "100ms",
                                    "-o", "both.anim", "--json"});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  const Clip out = read("both.anim");
  EXPECT_LT((joint_of(out, 30, out.skeleton.find("RightHand")).position - to).norm(), 1e-4);
  const json result = json::parse(both.out)["result"];
  EXPECT_EQ(result["goals"][0]["reached_frames"], result["goals"][0]["full_strength_frames"]);
  EXPECT_LT(result["plant"]["drift"], 0.0005);
  for (int f = 0; f < out.frame_count(); ++f) {
    for (const char* foot : {"LeftFoot", "RightFoot", "LeftToeBase", "RightToeBase"}) {
      const auto j = at(out.skeleton.find(foot));
      EXPECT_EQ(out.frame_positions(f)[j], planted.frame_positions(f)[j]) << f << " " << foot;
    }
  }
  const auto& done = out.provenance.conversions;
  ASSERT_GE(done.size(), 2U);
  EXPECT_THAT(done[done.size() - 2], HasSubstr("feet planted in "));
  EXPECT_THAT(done.back(), HasSubstr("inverse kinematics: 1 goal"));
}

TEST_F(KrokIkPlant, ContactsComeFromTheSidecarOrAFile) {
  put("walk.keys.json", R"({"schema": "krok.keys/1", "contacts": [
    {"joint": "LeftToeBase", "start": 1.0, "end": 1.2, "place": [0, 0, 0]}]})");
  const auto balls_in = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = {"walk.anim", "--plant", "-o", "out.anim", "--json"};
    all.insert(all.end(), more.begin(), more.end());
    const auto done = run("krok-ik", all);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    const json planting = json::parse(done.out)["result"]["plant"];
    int balls = 0;
    for (const json& stay : planting["stays"]) balls += stay["part"] == "ball" ? 1 : 0;
    return std::pair(planting["contacts"].get<std::string>(), balls);
  };
  EXPECT_EQ(balls_in({}), std::pair(std::string("file"), 1));
  EXPECT_EQ(balls_in({"--contacts", "walk.keys.json"}), std::pair(std::string("file"), 1));
  const auto found = balls_in({"--contacts", "find"});
  EXPECT_EQ(found.first, "found");
  EXPECT_GT(found.second, 2);
}

TEST_F(KrokIkPlant, TheSameBytesForAnyNumberOfThreads) {
  const Vec3 to = wanted(read("walk.anim"));
  std::string one;
  for (const char* jobs : {"-j1", "-j4"}) {
    ASSERT_EQ(run("krok-ik", {"walk.anim", "--plant", "--reach", reach(to), jobs, "-o", "a.anim",
                              "--plot", "a.svg"})
                  .exit_code,
              0);
    const std::string both = get(path("a.anim")) + get(path("a.svg"));
    if (one.empty()) one = both;
    EXPECT_EQ(both, one);
  }
}

TEST_F(KrokIkPlant, AChartShowsWhatTheReportTells) {
  const Vec3 to = wanted(read("walk.anim")) + Vec3(3, 0, 0);
  const auto done =
      run("krok-ik", {"walk.anim", "--reach", reach(to), "--look-at", "head=2m,1m,9m@20f..40f",
                      "--limits", "auto", "-o", "far.anim", "--plot", "far.svg", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const std::string svg = get(path("far.svg"));
  EXPECT_THAT(svg, testing::StartsWith("<svg"));
  EXPECT_THAT(svg, HasSubstr(">Distance by which goals are missed</text>"));
  EXPECT_THAT(svg, HasSubstr(">Angle by which goals are missed</text>"));
  EXPECT_THAT(svg, HasSubstr(">Rotation beyond limits, largest of all joints</text>"));
  EXPECT_THAT(svg, HasSubstr(">RightHand</text>"));
  // Millimetres of a goal that is metres away.
  EXPECT_THAT(svg, HasSubstr(">2000</text>"));
  // A joint is named as holding back if and only if the report names it.
  const json goals = json::parse(done.out)["result"]["goals"];
  bool any = false;
  for (const json& goal : goals) {
    for (const json& frame : goal["frames"]) {
      if (frame["held_by"].is_null()) continue;
      any = true;
      EXPECT_THAT(svg, HasSubstr(">" + frame["held_by"].get<std::string>() + "</text>"));
    }
  }
  EXPECT_THAT(svg, any ? HasSubstr("limits hold a goal back")
                       : testing::Matcher<std::string>(Not(HasSubstr("hold a goal back"))));
  const auto outputs = json::parse(done.out)["outputs"];
  EXPECT_EQ(outputs.size(), 2U);

  // Without limits there is nothing about them.
  ASSERT_EQ(run("krok-ik", {"walk.anim", "--reach", reach(to), "-o", "a.anim", "--plot", "a.svg"})
                .exit_code,
            0);
  EXPECT_THAT(get(path("a.svg")), Not(HasSubstr("imits")));
  EXPECT_THAT(get(path("a.svg")), Not(HasSubstr("Angle by which")));
}

TEST_F(KrokIkPlant, WhatCannotBeDoneIsAnError) {
  const std::string good = reach(wanted(read("walk.anim")));
  put("chain.bvh", capture(60));
  refused({"chain.bvh", "--plant", "-o", "x.anim"}, "contacts-feet");
  put("none.json", R"({"schema": "krok.keys/1", "contacts": []})");
  refused({"walk.anim", "--plant", "--contacts", "none.json", "-o", "x.anim"}, "plant-contacts");
  refused({"walk.anim", "--reach", good, "--contacts", "none.json", "-o", "x.anim"}, "--plant");
  refused({"walk.anim", "--plant"}, "no output given");
  refused({"walk.anim", "--plant", "-o", "x.anim", "--plot", "x.svg"}, "--plot is for --goals");
  refused({"walk.anim", "--reach", good, "-o", "x.anim", "--plot", "x.txt"}, ".svg");
  refused({"walk.anim", "--reach", good, "--plot", "x.svg", "--out-dir", "out"}, "--plot");
}

}  // namespace
}  // namespace krok::test
