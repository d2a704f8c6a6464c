// If these fail, the command that lets a walker be pushed and walk on lets them fall, stop or
// end early; other joints move than were asked for; or wrong options pass.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/motion_fixture.h"
#include "core/index.h"
#include "samples/generator/walk.h"

namespace krok::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class PlayingOn : public MotionTest {
 protected:
  void SetUp() override { walk_ = write_walk(10); }

  ToolRun call(std::vector<std::string> arguments) const {
    return run_here("krok-ragdoll", std::move(arguments));
  }

  json report(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "walk.anim");
    arguments.insert(arguments.end(), {"-o", "out.anim"});
    return report_here("krok-ragdoll", std::move(arguments));
  }

  static Vec3 place(const Clip& clip, const std::string& joint, int frame) {
    return clip.frame_positions(frame)[at(clip.skeleton.find(joint))].cast<double>();
  }

  Clip walk_;
};

TEST_F(PlayingOn, ASeedWithoutPushesIsRefused) {
  const auto run = call({"walk.anim", "--powered", "0.5", "--seed", "3", "-o", "out.anim"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--push-every"));
}

// A walk 5 cm in the ground with its hips held: legs cannot do both.
TEST_F(PlayingOn, FollowsOrWarns) {
  EXPECT_TRUE(report({"--powered", "1", "--hold", "1"})["issues"].empty());
  const json sunk = report({"--powered", "1", "--hold", "1", "--ground", "level:height=5cm"});
  EXPECT_GT(sunk["result"]["off_motion"]["mean_angle"].get<double>(), 5);
  ASSERT_EQ(sunk["issues"].size(), 1U) << sunk["issues"];
  EXPECT_EQ(sunk["issues"][0]["code"], "ragdoll-off-motion");
}

// The one line of the manual: pushed at 2 s and 4 s, to opposite sides, visibly; walks on to the
// motion's end, and there is no warning that he does not lie still.
TEST_F(PlayingOn, AWalkerIsPushedAndWalksOn) {
  report({"--powered", "0.6"});
  const Clip calm = read("out.anim");
  const json pushed = report({"--powered", "0.6", "--push-every", "2s"});
  const Clip out = read("out.anim");
  ASSERT_EQ(out.frame_count(), walk_.frame_count());
  EXPECT_TRUE(pushed["issues"].empty()) << pushed["issues"];
  EXPECT_LT(pushed["result"]["largest"]["penetration"].get<double>(), 0.005);
  const auto aside = [&](int frame) {
    return place(out, "Spine2", frame).x() - place(calm, "Spine2", frame).x();
  };
  EXPECT_NEAR(aside(119), 0, 1e-6);
  EXPECT_GT(aside(132), 0.04);   // to the left, +X
  EXPECT_LT(aside(252), -0.04);  // 2 s later to the right
  EXPECT_NEAR(aside(230), 0, 0.02);
  const int last = out.frame_count() - 1;
  EXPECT_LT((place(out, "Hips", last) - place(walk_, "Hips", last)).norm(), 0.15);
  // Other directions for another seed, the same for the same, with any number of threads.
  const json again = report({"--powered", "0.6", "--push-every", "2s", "-j", "2"});
  EXPECT_EQ(again["result"]["hash"], pushed["result"]["hash"]);
  const json other = report({"--powered", "0.6", "--push-every", "2s", "--seed", "7"});
  EXPECT_NE(other["result"]["hash"], pushed["result"]["hash"]);
}

// Full strength and a root that is animated: within 5 degrees RMS of the motion, and in the report.
TEST_F(PlayingOn, TheReportSaysHowFarItIsOffTheMotion) {
  const json held = report({"--powered", "1", "--hold", "1"});
  const double mean = held["result"]["off_motion"]["mean_angle"];
  EXPECT_GT(mean, 0);
  EXPECT_LT(mean, 5);
  const json free = report({"--powered", "0.6", "--hold", "0", "--duration", "3s"});
  EXPECT_GT(free["result"]["off_motion"]["mean_angle"].get<double>(), 20);
  EXPECT_LT(place(read("out.anim"), "Hips", 180).y(), 0.5);  // nobody holds him: he falls
}

TEST_F(PlayingOn, OnlyTheNamedJointsAreSimulated) {
  report({"--simulated", "left_upper_arm", "--simulated", "RightForeArm"});
  const Clip out = read("out.anim");
  bool moved = false;
  for (int frame = 0; frame < walk_.frame_count(); ++frame) {
    for (const char* joint : {"Hips", "Head", "LeftFoot", "RightArm"}) {
      ASSERT_EQ(place(out, joint, frame), place(walk_, joint, frame)) << joint << frame;
    }
    moved =
        moved || (place(out, "LeftHand", frame) - place(walk_, "LeftHand", frame)).norm() > 0.05;
  }
  EXPECT_TRUE(moved);
}

// From 2.3 s on the motion takes over, and 0.5 s later there is nothing else.
TEST_F(PlayingOn, UntilATimeAndThenTheMotion) {
  report({"--powered", "0.6", "--push-every", "2s", "--until", "2.3s"});
  const Clip out = read("out.anim");
  ASSERT_EQ(out.frame_count(), walk_.frame_count());
  EXPECT_GT((place(out, "Spine2", 138) - place(walk_, "Spine2", 138)).norm(), 0.03);
  for (int frame = 168; frame < walk_.frame_count(); ++frame) {
    ASSERT_EQ(place(out, "Spine2", frame), place(walk_, "Spine2", frame));
  }
}

// Modes in a saved file are those of the options, and give the same bytes without them.
TEST_F(PlayingOn, SavedModesGiveTheSameMotion) {
  const json first =
      report({"--powered", "0.4", "--hold", "0.3", "--save-bodies", "b.ragdoll.json"});
  const json again = report({"--bodies", "b.ragdoll.json"});
  EXPECT_EQ(first["result"]["hash"], again["result"]["hash"]);
}

TEST_F(PlayingOn, WrongOptionsAreTold) {
  const auto refused = [&](std::vector<std::string> arguments, const std::string& code,
                           const std::string& text) {
    arguments.insert(arguments.begin(), "walk.anim");
    arguments.insert(arguments.end(), {"-o", "no.anim"});
    const auto run = call(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr("[" + code + "]"));
    EXPECT_THAT(run.err, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(path("no.anim")));
  };
  refused({"--powered", "2"}, "usage", "--powered: '2'");
  refused({"--powered", "0.5", "--hold", "x"}, "usage", "--hold: 'x'");
  refused({"--simulated", "Wing"}, "ragdoll-joint", "Wing");
  refused({"--simulated", "Head_end"}, "ragdoll-joint", "no body");
  refused({"--until", "2s"}, "usage", "--until");
  refused({"--powered", "1", "--until", "90s"}, "ragdoll-time", "--until 90 s");
  refused({"--powered", "1", "--until", "2s", "--duration", "1s"}, "usage", "--duration");
  refused({"--powered", "1", "--get-up", "walk.anim"}, "usage", "--get-up");
  refused({"--powered", "1", "--push-every", "0s"}, "usage", "--push-every");
}

}  // namespace
}  // namespace krok::test
