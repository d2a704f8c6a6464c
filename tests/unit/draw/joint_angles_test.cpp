// If these fail, angles on charts are not those that the joints have.

#include "draw/joint_angles.h"

#include <gmock/gmock.h>

#include <cmath>

#include "unit/draw/moving_actors.h"

namespace krok::draw {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

TEST(BodyAngle, IsZeroStandingUprightWithArmsHanging) {
  const Shown shown(
      posed({{{"LeftArm", about(krok::Axis::z, -90)}, {"RightArm", about(krok::Axis::z, 90)}}}));
  for (const Side side : {Side::left, Side::right}) {
    for (const BodyAngle which : {BodyAngle::hip, BodyAngle::knee, BodyAngle::ankle,
                                  BodyAngle::shoulder, BodyAngle::elbow}) {
      EXPECT_NEAR(shown.angle(which, side), 0, 0.05) << static_cast<int>(which);
    }
  }
}

TEST(BodyAngle, IsWhatAJointIsBentBy) {
  // Thigh forward, shank back, toes up; the left arm of the T-pose bent forward at the elbow.
  const Turns pose = {
      {"LeftUpLeg", about(krok::Axis::x, -35)}, {"LeftLeg", about(krok::Axis::x, 60)},
      {"LeftFoot", about(krok::Axis::x, -15)},  {"RightUpLeg", about(krok::Axis::x, 20)},
      {"RightFoot", about(krok::Axis::x, 25)},  {"LeftForeArm", about(krok::Axis::y, -80)}};
  const Transform place = {Vec3(3, 0.4, -2), about(krok::Axis::y, 130) * about(krok::Axis::x, 40)};
  for (const Transform& where : {Transform(), place}) {
    const Shown shown(posed({pose}, where));
    EXPECT_NEAR(shown.angle(BodyAngle::hip, Side::left), 35, kTight);
    EXPECT_NEAR(shown.angle(BodyAngle::hip, Side::right), -20, kTight);
    EXPECT_NEAR(shown.angle(BodyAngle::knee, Side::left), 60, kTight);
    EXPECT_NEAR(shown.angle(BodyAngle::knee, Side::right), 0, 0.05);
    // The feet point a little outwards, so they do not turn quite in the plane of the shank.
    EXPECT_NEAR(shown.angle(BodyAngle::ankle, Side::left), 15, 0.05);
    EXPECT_NEAR(shown.angle(BodyAngle::ankle, Side::right), -25, 0.05);
    EXPECT_NEAR(shown.angle(BodyAngle::shoulder, Side::left), 90, kTight);
    EXPECT_NEAR(shown.angle(BodyAngle::elbow, Side::left), 80, kTight);
    EXPECT_NEAR(shown.angle(BodyAngle::elbow, Side::right), 0, 0.05);
  }
}

TEST(BodyAngle, DoesNotDependOnHowBonesAreAligned) {
  const Turns pose = {{"LeftUpLeg", about(krok::Axis::x, -35)},
                      {"LeftLeg", about(krok::Axis::x, 60)},
                      {"LeftFoot", about(krok::Axis::x, -15)}};
  Clip turned = posed({pose});
  for (std::size_t j = 0; j < turned.skeleton.names.size(); ++j) {
    const Quat own = about(krok::Axis::z, 90) * about(krok::Axis::y, 17.0 * static_cast<double>(j));
    turned.skeleton.reference[j].orientation = turned.skeleton.reference[j].orientation * own;
    turned.orientations[j] = turned.orientations[j] * own.cast<float>();
  }
  const Shown plain(posed({pose})), other(std::move(turned));
  for (const BodyAngle which : {BodyAngle::hip, BodyAngle::knee, BodyAngle::ankle}) {
    EXPECT_NEAR(other.angle(which, Side::left), plain.angle(which, Side::left), kTight);
  }
}

TEST(BodyAngle, OfABoneWithoutLengthIsNoNumberAndLeavesAGap) {
  Clip clip = posed({{}, {}, {}});
  const int knee = clip.skeleton.find("LeftLeg"), hip = clip.skeleton.find("LeftUpLeg");
  clip.frame_positions(1)[static_cast<std::size_t>(knee)] =
      clip.frame_positions(1)[static_cast<std::size_t>(hip)];
  const Shown shown(std::move(clip));
  const auto values =
      body_angle(shown.clip, shown.roles, BodyAngle::knee, Side::left, shown.charted.frames);
  ASSERT_THAT(values, SizeIs(3));
  EXPECT_TRUE(std::isnan(values[1]));
  Chart chart;
  chart.panels = body_angle_panels({&shown.charted, 1});
  const auto svg = to_svg(chart);
  ASSERT_TRUE(svg.ok());
  EXPECT_THAT(*svg, Not(HasSubstr("nan")));
}

TEST(BodyAngle, OfAThighToTheSideIsNoHipFlexionAndOneFarBackDoesNotJump) {
  const Shown shown(posed({{{"LeftUpLeg", about(krok::Axis::z, 85)}},
                           {{"LeftUpLeg", about(krok::Axis::x, -175)}},
                           {{"LeftUpLeg", about(krok::Axis::x, -185)}},
                           {{"LeftUpLeg", about(krok::Axis::x, 60)}}}));
  const auto values =
      body_angle(shown.clip, shown.roles, BodyAngle::hip, Side::left, shown.charted.frames);
  ASSERT_THAT(values, SizeIs(4));
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_NEAR(values[1], 175, kTight);
  EXPECT_NEAR(values[2], 185, kTight);
  EXPECT_NEAR(values[3], -60, kTight);
}

TEST(TurnAngle, IsTheTurnAwayFromTheReferencePose) {
  const Shown shown(posed({{}, {{"LeftForeArm", about(krok::Axis::y, -75)}}},
                          {Vec3::Zero(), about(krok::Axis::y, 50)}));
  const int elbow = shown.clip.skeleton.find("LeftForeArm");
  EXPECT_THAT(turn_angle(shown.clip, elbow, {0, 1}),
              ElementsAre(DoubleNear(0, 0.05), DoubleNear(75, kTight)));
  EXPECT_THAT(turn_angle(shown.clip, 0, {0, 0}), ElementsAre(DoubleNear(50, kTight)));
  EXPECT_THAT(turn_angle(shown.clip, elbow, {1, 0}), IsEmpty());
}

TEST(EulerAngles, GoOnBeyondHalfATurn) {
  std::vector<Turns> poses;
  for (int f = 0; f < 40; ++f) {
    poses.push_back({{"LeftArm", about(krok::Axis::z, 10.0 * f) * about(krok::Axis::x, 20)}});
  }
  const Shown shown(posed(poses));
  const int arm = shown.clip.skeleton.find("LeftArm");
  const auto angles = euler_angles(shown.clip, arm, {krok::Axis::z, krok::Axis::x, krok::Axis::y},
                                   shown.charted.frames);
  ASSERT_THAT(angles, SizeIs(3));
  for (std::size_t f = 0; f < 40; ++f) {
    EXPECT_NEAR(angles[0][f], 10.0 * static_cast<double>(f), 0.01);
    EXPECT_NEAR(angles[1][f], 20, 0.01);
    EXPECT_NEAR(angles[2][f], 0, 0.01);
  }
}

}  // namespace
}  // namespace krok::draw
