// If these fail, a foot that swings hits the ground, or is raised far more than it needs.
#include <gtest/gtest.h>

#include <cmath>

#include "gait/foot_paths_internal.h"
#include "math/quaternion.h"
#include "unit/gait/walkers.h"

namespace krok::gait {
namespace {

constexpr double kAnkle = 0.09, kOff = 1, kStrike = 1.48, kClearance = 0.015;  // metres, seconds

Leg plain_leg() {
  Leg leg;
  leg.length = 0.8;
  leg.sole.heel = Vec3(0, -kAnkle, -0.06);
  leg.sole.ball = leg.sole.pivot = Vec3(0, -kAnkle, 0.09);
  leg.sole.length = 0.15;
  leg.sole.tip = 0.05;
  return leg;
}

// A foot that swings ahead over 1.2 m and points down by 12 degrees before it lands.
FootPose pointing_foot(double time) {
  const double u = std::clamp((time - kOff) / (kStrike - kOff), 0.0, 1.0);
  const double down = smoother_step((u - 0.5) / 0.2) * smoother_step((1 - u) / 0.12);
  FootPose foot;
  foot.foot.position =
      Vec3(0, kAnkle + 0.12 * std::pow(4 * u * (1 - u), 3), 1.2 * smoother_step(u));
  foot.foot.orientation = from_rotation_vector(Vec3(12 * kRadiansPerDegree * down, 0, 0));
  foot.toes = foot.foot.orientation;
  return foot;
}

// Would fail if the ankle went up by a decimetre for toes that are low just before they land: the
// foot stamps down in a frame or two, and the knee snaps straight.
TEST(Swing, ToesAreRaisedByTheAnkleBeforeTheFoot) {
  const Leg leg = plain_leg();
  const test::Ground level([](double, double) { return 0.0; });
  Swing swing(leg, kOff, kStrike, 0.16);
  Swing::Ends off, strike;
  off.spacing = strike.spacing = 0.01;
  for (std::size_t i = 0; i < 3; ++i) {
    off.blend[i] = off.wanted[i] = pointing_foot(kOff);
    strike.blend[i] = strike.wanted[i] = pointing_foot(kStrike);
  }
  swing.set_ends(off, strike);
  std::vector<double> times;
  std::vector<FootPose> blend;
  for (double time = kOff; time < kStrike; time += 1.0 / 60) {
    times.push_back(time);
    blend.push_back(pointing_foot(time));
  }
  double lowest = 1;
  for (const FootPose& foot : blend) lowest = std::min(lowest, sole_points(leg, foot)[2].y());
  ASSERT_LT(lowest, -0.015);
  swing.clear(level, times, blend, kClearance, 0);
  double raised = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const FootPose foot = swing.at(times[i], blend[i]);
    raised = std::max(raised, foot.foot.position.y() - blend[i].foot.position.y());
    const double u = (times[i] - kOff) / (kStrike - kOff);
    if (u < 0.3 || u > 0.75) continue;
    for (const Vec3& point : sole_points(leg, foot)) EXPECT_GT(point.y(), kClearance) << u;
  }
  EXPECT_LT(raised, 0.02);
}

// Would fail if the tip of the toes slid from when the ball leaves the ground till the toes do, by
// 3 to 5 cm, or if the foot jumped when they do.
TEST(Swing, TheTipOfTheToesStaysTillItLeaves) {
  Leg leg = plain_leg();
  leg.toes = 1;
  constexpr double kUntil = kOff + 0.08;
  const auto moving = [](double time, double speed) {
    FootPose foot;
    foot.foot.position = Vec3(0, kAnkle, speed * (time - kOff));
    return foot;
  };
  Swing::Ends off, strike;
  off.spacing = strike.spacing = 0.01;
  std::vector<double> times;
  std::vector<FootPose> slow, fast, rising;
  for (double time = kOff; time < kStrike; time += 0.01) {
    times.push_back(time);
    slow.push_back(moving(time, 0.3));
    fast.push_back(moving(time, 1.5));
    rising.push_back(moving(time, 0.3));
    rising.back().foot.position.y() += 0.1 * (time - kOff);
  }
  std::array<FootPose, 3> before;
  for (std::size_t i = 0; i < 3; ++i) {
    const double back = 0.01 * static_cast<double>(i);
    off.blend[i] = moving(kOff - back, 0.3), off.wanted[i] = moving(kOff, 0);
    strike.blend[i] = strike.wanted[i] = moving(kStrike + back, 0.3);
    before[i] = moving(kUntil - back, 0.3);
  }
  Swing swing(leg, kOff, kStrike, 0.16);
  swing.set_ends(off, strike);
  // A tip that has left the ground in the blend is not kept.
  EXPECT_LT(swing.tip_stays_until(kUntil, times, fast), kUntil);
  // Would fail if a foot in the air were held back, to catch up with twice the jerk of people's.
  EXPECT_NEAR(swing.tip_stays_until(kUntil, times, rising), kOff + 0.02, 0.011);
  ASSERT_EQ(swing.tip_stays_until(kUntil, times, slow), kUntil);
  const Vec3 place = sole_points(leg, off.wanted[0])[2];
  const FootPose free = swing.at(kUntil, before[0]);
  EXPECT_GT((sole_points(leg, free)[2] - place).norm(), 0.005);
  swing.keep_tip(kUntil, before, 0.01);
  Vec3 last = place;
  for (double time = kOff; time < kStrike; time += 0.001) {
    const Vec3 tip = sole_points(leg, swing.at(time, moving(time, 0.3)))[2];
    if (time <= kUntil) {
      EXPECT_LT((tip - place).norm(), 1e-9) << time;
    }
    EXPECT_LT((tip - last).norm(), 0.001) << time;
    last = tip;
  }
}

// Would fail if a foot that is to be raised by two centimetres before it lands, as down slopes,
// were moved past its print by 15 cm and back instead: its leg is then too short, and its knee
// jumps.
TEST(Swing, AFootIsRaisedDownASlopeNotMovedPastItsPrint) {
  const Leg leg = plain_leg();
  constexpr double kFall = 0.1, kToesUp = 15 * kRadiansPerDegree;
  const test::Ground slope([](double, double z) { return -kFall * z; });
  Swing swing(leg, kOff, kStrike, 0.16);
  const auto on_slope = [](double z, double toes_up) {
    FootPose foot;
    foot.foot.orientation = from_rotation_vector(Vec3(std::atan(kFall) - toes_up, 0, 0));
    foot.foot.position = foot.foot.orientation * Vec3(0, kAnkle, 0) + Vec3(0, -kFall * z, z);
    foot.toes = foot.foot.orientation;
    return foot;
  };
  // The blend walks on the level, as high as the middle between the prints.
  const auto on_level = [](double time) {
    const double u = std::clamp((time - kOff) / (kStrike - kOff), 0.0, 1.0);
    FootPose foot;
    foot.foot.orientation =
        from_rotation_vector(Vec3(-kToesUp * smoother_step((u - 0.6) / 0.3), 0, 0));
    foot.foot.position = Vec3(0, kAnkle - 0.6 * kFall + 0.04 * u * (1 - u), 1.2 * smoother_step(u));
    foot.toes = foot.foot.orientation;
    return foot;
  };
  Swing::Ends off, strike;
  off.spacing = strike.spacing = 0.01;
  for (std::size_t i = 0; i < 3; ++i) {
    off.blend[i] = on_level(kOff), off.wanted[i] = on_slope(0, 0);
    strike.blend[i] = on_level(kStrike), strike.wanted[i] = on_slope(1.2, kToesUp);
  }
  swing.set_ends(off, strike);
  std::vector<double> times;
  std::vector<FootPose> blend;
  for (double time = kOff; time < kStrike; time += 1.0 / 60) {
    times.push_back(time);
    blend.push_back(on_level(time));
  }
  std::vector<double> plain;
  for (std::size_t i = 0; i < times.size(); ++i) {
    plain.push_back(swing.at(times[i], blend[i]).foot.position.z());
  }
  swing.clear(slope, times, blend, kClearance, 0);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(swing.at(times[i], blend[i]).foot.position.z(), plain[i], 0.02) << times[i];
  }
}

// Would fail if a foot that lands nearly flat were flat at once: its swing then takes on a velocity
// that no foot has, and throws the toes up by a decimetre to do so.
TEST(Stance, AFootThatLandsNearlyFlatDoesNotStopDead) {
  const Leg leg = plain_leg();
  const auto pitched = [](double degrees) {
    FootPose foot;
    foot.foot.orientation = from_rotation_vector(Vec3(-degrees * kRadiansPerDegree, 0, 0));
    foot.toes = foot.foot.orientation;
    return foot;
  };
  Stance stance(leg, GroundedPrint(), pitched(0));
  stance.strike = 1;
  stance.flat_to = stance.off = 2;
  stance.be_flat(1.01, 1.3);
  const Quat lands = stance.at(1, pitched(6)).foot.orientation;
  const Quat after = stance.at(1.01, pitched(4)).foot.orientation;
  // No more than half as fast again as the blend.
  EXPECT_LT(lands.angularDistance(after), 3 * kRadiansPerDegree);
  EXPECT_LT(stance.at(1.07, pitched(2)).foot.orientation.angularDistance(Quat::Identity()), 1e-6);
  // What the blend brings down by itself is not brought down twice as fast.
  stance.be_flat(1.07, 1.3);
  const Quat halfway = stance.at(1.035, pitched(7)).foot.orientation;
  EXPECT_NEAR(halfway.angularDistance(Quat::Identity()), 7 * kRadiansPerDegree, 1e-6);
  // The middle of the stance is flat in any case.
  stance.be_flat(1.01, 1.02);
  EXPECT_EQ(stance.flat_from, 1.02);
}

// Would fail if a foot that is flat nearly till it leaves turned within 5 ms as far as the blend's,
// which the swing cannot follow: a foot turned by 120 degrees in a frame.
TEST(Stance, AFootThatLeavesHasTimeToTurn) {
  Stance stance(plain_leg(), GroundedPrint(), FootPose());
  stance.flat_from = 1.2;
  stance.off = 2;
  stance.leave(1.995, 1.5);
  EXPECT_LE(stance.flat_to, 1.94);
  // The middle of the stance is flat in any case.
  stance.leave(1.995, 1.98);
  EXPECT_EQ(stance.flat_to, 1.98);
}

// Would fail if a foot whose heel rises late took the heading of the blend's, which turned on its
// ball while flat, in a frame or two: ankles jumped by 17 degrees in walks that turn.
TEST(Stance, AFootThatLeavesTurnsAsideSlowly) {
  const Leg leg = plain_leg();
  FootPose turned;
  turned.foot.orientation = from_rotation_vector(Vec3(0, 20 * kRadiansPerDegree, 0));
  turned.toes = turned.foot.orientation;
  Stance stance(leg, GroundedPrint(), FootPose());
  stance.flat_to = 1.94;
  stance.off = 2;
  double fastest = 0;
  for (double time = stance.flat_to; time + 1.0 / 60 <= stance.off; time += 0.005) {
    const Quat now = stance.at(time, turned).foot.orientation;
    const Quat next = stance.at(time + 1.0 / 60, turned).foot.orientation;
    fastest = std::max(fastest, now.angularDistance(next) / kRadiansPerDegree);
  }
  EXPECT_LT(fastest, 5);
}

// Would fail if a foot that strikes with its toes up turned about the corner of a sharp heel: the
// ankle is a centimetre too high, and the knee bent by 22 degrees where captures have 14.
TEST(Stance, AFootRollsOverItsRoundHeel) {
  Leg leg = plain_leg();
  leg.sole.heel_radius = 0.03;
  FootPose pitched;
  pitched.foot.orientation = from_rotation_vector(Vec3(-20 * kRadiansPerDegree, 0, 0));
  pitched.toes = pitched.foot.orientation;
  Stance stance(leg, GroundedPrint(), FootPose());
  stance.strike = 1;
  stance.flat_to = stance.off = 2;
  stance.be_flat(1.2, 1.3);
  const auto middle = [&](double time) {
    return Vec3(stance.at(time, pitched).foot * leg.sole.heel_middle());
  };
  const FootPose strikes = stance.at(1, pitched);
  EXPECT_NEAR(
      strikes.foot.position.y(),
      0.03 + 0.06 * std::cos(20 * kRadiansPerDegree) + 0.03 * std::sin(20 * kRadiansPerDegree),
      1e-9);
  EXPECT_LT(sole_points(leg, strikes)[0].y(), -0.007);
  // It rolls on the ground without sliding, and lies on the print in the end.
  for (double time = 1; time < 1.25; time += 0.01) {
    const Quat turned = stance.at(time, pitched).foot.orientation;
    const double angle = turned.angularDistance(Quat::Identity());
    EXPECT_NEAR(middle(time).y(), 0.03, 1e-9) << time;
    EXPECT_NEAR(middle(time).z(), 0.03 * (1 - angle), 1e-9) << time;
  }
  EXPECT_LT(sole_points(leg, stance.at(1.25, pitched))[0].norm(), 1e-9);
}

// Would fail if the radius were not learned, or found where heels are sharp: those of generated
// walks are, and 2 cm behind them a corner is where a round heel's would be.
TEST(Stance, TheRoundnessOfHeelsIsLearned) {
  const auto radius = [](std::span<const StepLibrary> libraries) {
    auto walker = make_walker(libraries);
    EXPECT_TRUE(walker.ok());
    return walker->legs[0].sole.heel_radius;
  };
  EXPECT_LT(radius(test::walking()), 0.002);
  parametric::Library library = test::walking().front().library();
  for (parametric::FootShape& foot : library.feet) {
    foot.heel -= 0.02 * foot.forward;
    foot.length += 0.02;
  }
  const StepLibrary farther = test::walking_library(std::move(library));
  EXPECT_NEAR(radius(std::span(&farther, 1)), 0.025, 0.004);
}

}  // namespace
}  // namespace krok::gait
