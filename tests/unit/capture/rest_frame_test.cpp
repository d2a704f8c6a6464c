// If these fail, a T-pose in front of a motion goes unnoticed and stays in it, or the beginning of
// a motion is taken for one.

#include "capture/rest_frame.h"

#include <gmock/gmock.h>

#include "math/quaternion.h"
#include "support/human_skeleton.h"

namespace krok {
namespace {

constexpr double kDegree = kRadiansPerDegree;

// The human figure with its arms and thighs turned: a frame for each number of degrees.
Capture turned(const std::vector<double>& degrees) {
  Capture capture;
  Clip& clip = capture.clip;
  clip.skeleton = test::human_skeleton();
  clip.resize(static_cast<int>(degrees.size()));
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  for (std::size_t f = 0; f < degrees.size(); ++f) {
    std::vector<Transform> local(joints), world(joints);
    for (std::size_t j = 0; j < joints; ++j) {
      local[j] = clip.skeleton.reference_local(static_cast<int>(j));
    }
    for (const auto& [name, share] :
         {std::pair("LeftArm", -1.0), std::pair("RightArm", 1.0), std::pair("LeftUpLeg", 0.2),
          std::pair("RightUpLeg", -0.2), std::pair("LeftForeArm", -0.2)}) {
      const auto joint = static_cast<std::size_t>(clip.skeleton.find(name));
      local[joint].orientation = axis_rotation(Axis::z, share * degrees[f] * kDegree);
    }
    local_to_world(clip.skeleton.parents, local, world);
    clip.set_pose(static_cast<int>(f), world);
  }
  capture.roles = find_roles(clip.skeleton);
  return capture;
}

// What is found, told and left of these frames.
RestPose settle(const std::vector<double>& degrees, RestFrame wish, Capture& capture) {
  capture = turned(degrees);
  const RestPose rest = find_rest_pose(capture.clip, capture.roles);
  const bool dropped = settle_rest_frame(rest, wish, "test", "a.file", capture);
  EXPECT_EQ(capture.clip.frame_count(), static_cast<int>(degrees.size()) - (dropped ? 1 : 0));
  EXPECT_TRUE(check(capture.clip).ok());
  return rest;
}

const std::vector<double> kTPoseFirst = {0, 70, 71, 72, 73, 74, 75};
const std::vector<double> kEven = {0, 5, 10, 15, 20, 25, 30};

TEST(RestFrame, ATPoseInFrontOfAMotionIsFound) {
  Capture capture;
  const RestPose kept = settle(kTPoseFirst, RestFrame::keep, capture);
  EXPECT_TRUE(kept.first_frame_is_rest);
  EXPECT_EQ(kept.reason, "frame 0 is a T-pose, 70 degrees away from frame 1");
  EXPECT_EQ(kept.reference, "a T-pose");
  ASSERT_EQ(capture.diagnostics.size(), 1u);
  EXPECT_EQ(capture.diagnostics[0].code, "test-rest-frame");
  EXPECT_EQ(capture.diagnostics[0].severity, Severity::warning);
  EXPECT_EQ(capture.diagnostics[0].where.file, "a.file");
  EXPECT_EQ(capture.clip.frame_count(), 7);

  settle(kTPoseFirst, RestFrame::automatic, capture);
  EXPECT_EQ(capture.clip.frame_count(), 6);
  const Clip whole = turned(kTPoseFirst).clip;
  EXPECT_EQ(
      capture.clip.positions,
      std::vector<Vec3f>(whole.positions.begin() + whole.joint_count(), whole.positions.end()));
  EXPECT_EQ(capture.diagnostics[0].severity, Severity::note);
  EXPECT_THAT(capture.clip.provenance.conversions,
              testing::ElementsAre("the first frame, a rest pose, was dropped"));
}

// Packs of ReadyPlayerMe hold it for two or three frames, with one halfway: no word of it, and a
// gait table was wrong by 14 %.
TEST(RestFrame, ATPoseThatIsHeldIsFoundWithTheWayFromIt) {
  Capture capture;
  const RestPose held = settle({0, 0, 0, 70, 71, 72, 73, 74}, RestFrame::automatic, capture);
  EXPECT_FALSE(held.first_frame_is_rest);
  EXPECT_EQ(held.frames, 3);
  EXPECT_EQ(held.reason, "frames 0 to 2 are a T-pose, 70 degrees away from frame 3");
  ASSERT_EQ(capture.diagnostics.size(), 1u);
  EXPECT_EQ(capture.diagnostics[0].hint, "drop them with krok-edit --from 3f");
  EXPECT_EQ(settle({0, 0, 35, 70, 71, 72, 73}, RestFrame::keep, capture).frames, 3);
  EXPECT_EQ(settle({0, 0, 20, 40, 60, 80, 100}, RestFrame::keep, capture).frames, 0);
  EXPECT_EQ(settle({0, 0, 0, 0, 0, 0, 0, 0}, RestFrame::keep, capture).frames, 0);
}

TEST(RestFrame, AMotionThatBeginsInATPoseIsNone) {
  Capture capture;
  const RestPose rest = settle(kEven, RestFrame::automatic, capture);
  EXPECT_FALSE(rest.first_frame_is_rest);
  EXPECT_EQ(rest.reference, "a T-pose; the motion starts in a T-pose");
  EXPECT_EQ(capture.clip.frame_count(), 7);
  EXPECT_TRUE(capture.diagnostics.empty());
}

TEST(RestFrame, TheFirstFrameGoesWhereThatIsAskedFor) {
  Capture capture;
  settle(kEven, RestFrame::drop, capture);
  EXPECT_EQ(capture.clip.frame_count(), 6);
  ASSERT_EQ(capture.diagnostics.size(), 1u);
  EXPECT_EQ(capture.diagnostics[0].message, "the first frame was dropped as requested");
}

TEST(RestFrame, FewFramesTellNothing) {
  for (const std::vector<double>& degrees :
       {std::vector<double>{}, std::vector<double>{0}, std::vector<double>{0, 70, 71}}) {
    Capture capture;
    EXPECT_FALSE(settle(degrees, RestFrame::automatic, capture).first_frame_is_rest);
    EXPECT_TRUE(capture.diagnostics.empty());
  }
  Capture none;
  EXPECT_FALSE(settle_rest_frame({}, RestFrame::drop, "test", "", none));
}

}  // namespace
}  // namespace krok
