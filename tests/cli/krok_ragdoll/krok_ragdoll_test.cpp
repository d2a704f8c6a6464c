// If these fail, krok-ragdoll writes another fall than it was asked for, hides that the figure
// still moves, or ends wrongly on wrong input.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/motion_fixture.h"
#include "core/file.h"
#include "core/index.h"
#include "formats/anim/anim.h"
#include "samples/generator/walk.h"
#include "support/height_images.h"

namespace krok::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class KrokRagdoll : public MotionTest {
 protected:
  void SetUp() override { walk_ = write_walk(4); }

  ToolRun fall(std::vector<std::string> arguments) const {
    return run_here("krok-ragdoll", std::move(arguments));
  }

  json report(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"-o", "out.anim"});
    return report_here("krok-ragdoll", std::move(arguments));
  }

  float hips_height(const Clip& clip, int frame) const {
    return clip.frame_positions(frame)[at(clip.skeleton.find("Hips"))].y();
  }

  Clip walk_;
};

TEST_F(KrokRagdoll, AShovedWalkerFallsToTheGround) {
  const json first =
      report({"walk.anim", "--at", "1s", "--push", "Spine2=90Ns,0,20Ns", "--duration", "4s"});
  const json& result = first["result"];
  EXPECT_EQ(result["first_simulated_frame"], 60);
  EXPECT_EQ(result["frames"], 301);
  EXPECT_EQ(result["bodies"], 16);
  EXPECT_LT(result["largest"]["penetration"].get<double>(), 0.005);
  EXPECT_LT(result["largest"]["limit_excess"].get<double>(), 1);
  const Clip out = read("out.anim");
  EXPECT_LT(hips_height(out, 300), 0.35f);
  EXPECT_GT(hips_height(out, 300), 0.05f);
  EXPECT_NEAR(hips_height(out, 59), hips_height(walk_, 59), 1e-6f);
  EXPECT_EQ(out.provenance.tool, "krok-ragdoll");
  // The push is to the left, +X.
  const int hips = out.skeleton.find("Hips");
  EXPECT_GT(out.frame_positions(300)[at(hips)].x(), out.frame_positions(60)[at(hips)].x() + 0.2f);
  const json again = report(
      {"walk.anim", "--at", "1s", "--push", "Spine2=90Ns,0,20Ns", "--duration", "4s", "-j", "2"});
  EXPECT_EQ(again["result"]["hash"], result["hash"]);
  const json other =
      report({"walk.anim", "--at", "1s", "--push", "Spine2=-90Ns,0,20Ns", "--duration", "4s"});
  EXPECT_NE(other["result"]["hash"], result["hash"]);
}

TEST_F(KrokRagdoll, WhatStillMovesAtTheEndIsTold) {
  const json early = report({"walk.anim", "--at", "1s", "--duration", "300ms"});
  EXPECT_TRUE(early["result"]["rest_time"].is_null());
  EXPECT_EQ(early["issues"][0]["code"], "ragdoll-moving");
}

TEST_F(KrokRagdoll, WhatMissesATolerancePrintsAWarning) {
  const json torn = report({"walk.anim", "--at", "1s", "--push", "Head=3000Ns,0,0"});
  EXPECT_GT(torn["result"]["largest"]["limit_excess"].get<double>(), 1 * kRadiansPerDegree);
  EXPECT_THAT(torn["issues"].dump(), HasSubstr("ragdoll-limit"));
}

// Ranges are widened to the pose at the begin; where that is no pose of a person (or a role is
// wrong) the body lies wrung at the end, and nothing else says so.
TEST_F(KrokRagdoll, APoseFarBeyondItsRangesPrintsAWarning) {
  Clip wrung = walk_;
  const std::size_t neck = at(walk_.skeleton.find("Neck"));
  for (int f = 0; f < wrung.frame_count(); ++f) {
    auto orientations = wrung.frame_orientations(f);
    orientations[neck] = Quatf(Eigen::AngleAxisf(2.2F, Vec3f::UnitY())) * orientations[neck];
  }
  write("wrung.anim", wrung);
  const json fallen = report({"wrung.anim", "--at", "1s", "--duration", "3s"});
  EXPECT_THAT(fallen["issues"].dump(), HasSubstr("ragdoll-range"));
  EXPECT_THAT(fallen["issues"].dump(), HasSubstr("Neck"));
  const json plain = report({"walk.anim", "--at", "1s", "--duration", "3s"});
  EXPECT_THAT(plain["issues"].dump(), testing::Not(HasSubstr("ragdoll-range")));
}

// Captures often begin with a T-pose elsewhere; the speed from it to the first frame of the motion
// would throw the body out of the world.
TEST_F(KrokRagdoll, ABodyThatWasElsewhereAFrameBeforeFallsWithoutSpeed) {
  Clip jumps = walk_;
  for (Vec3f& place : jumps.frame_positions(0)) place.x() += 3;
  write("jumps.anim", jumps);
  const json jumped = report({"jumps.anim", "--at", "0s", "--duration", "2s"});
  EXPECT_THAT(jumped["issues"].dump(), HasSubstr("ragdoll-jump"));
  const Clip out = read("out.anim");
  const std::size_t hips = at(out.skeleton.find("Hips"));
  EXPECT_LT((out.frame_positions(120)[hips] - out.frame_positions(0)[hips]).norm(), 2.0f);
}

TEST_F(KrokRagdoll, AMotionWithoutFramesIsRefusedAsSuch) {
  Clip none = walk_;
  none.resize(0);
  write("none.anim", none);
  const auto run = fall({"none.anim", "-o", "out.anim"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("no frames"));
}

// Stairs that lead down take the walker further down than level ground does.
TEST_F(KrokRagdoll, TheGroundMayBeAnything) {
  report({"walk.anim", "--at", "1s", "--duration", "2s", "--push", "Spine2=0,0,60"});
  const float level = hips_height(read("out.anim"), 180);
  report({"walk.anim", "--at", "1s", "--duration", "2s", "--push", "Spine2=0,0,60", "--ground",
          "slope:angle=-25deg,begin=0m"});
  EXPECT_LT(hips_height(read("out.anim"), 180), level - 0.2f);
}

// Would fail if the ground was opened for each use of it, with its warnings again.
TEST_F(KrokRagdoll, TheGroundIsReadOnce) {
  put("hill.png", test::png_image(2, 2, 0, {0, 0, 9, 9}, 0, 0, 8));
  const json made = report({"walk.anim", "--at", "1s", "--duration", "1s", "--ground", "hill.png",
                            "--ground-size", "8mx8m", "--ground-range", "0m,1m"});
  EXPECT_EQ(std::ranges::count_if(
                made["issues"], [](const json& issue) { return issue["code"] == "ground-levels"; }),
            1);
}

TEST_F(KrokRagdoll, WrongInputIsToldAndNothingIsWritten) {
  const auto refused = [&](std::vector<std::string> arguments, const std::string& code,
                           const std::string& text) {
    arguments.insert(arguments.end(), {"-o", "no.anim"});
    const auto run = fall(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr("[" + code + "]"));
    EXPECT_THAT(run.err, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(path("no.anim")));
  };
  refused({"walk.anim", "--at", "99s"}, "ragdoll-time", "99s");
  refused({"walk.anim", "--at", "1s", "--push", "Wing=1,2,3"}, "ragdoll-joint", "Wing");
  refused({"walk.anim", "--at", "1s", "--push", "Hips=1,2"}, "usage", "three parts");
  refused({"walk.anim", "--at", "1s", "--push", "Hips=1,2,3@90s"}, "ragdoll-time", "Hips");
  refused({"walk.anim", "--at", "1s", "--ground", "swamp"}, "ground-kind", "swamp");
  refused({"walk.anim", "--at", "1s", "--friction", "-1"}, "usage", "--friction");
  // Below all of it.
  refused({"walk.anim", "--at", "1s", "--ground", "slope:angle=45deg,begin=-5m"}, "ragdoll-through",
          "through the ground");
}

// Would fail if a motion that is not made for its ground was pushed out of it in a frame without a
// word.
TEST_F(KrokRagdoll, WhatIsInTheGroundAtTheStartIsWarnedOf) {
  const json raised = report({"walk.anim", "--at", "1s", "--ground", "level:height=0.1"});
  EXPECT_THAT(raised["issues"].dump(), HasSubstr("when the body takes over"));
  const json on_it = report({"walk.anim", "--at", "1s", "--ground", "level"});
  EXPECT_THAT(on_it["issues"].dump(), Not(HasSubstr("when the body takes over")));
}

}  // namespace
}  // namespace krok::test
