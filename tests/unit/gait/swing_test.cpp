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
  // The middle of the stance is flat in any case.
  stance.be_flat(1.01, 1.02);
  EXPECT_EQ(stance.flat_from, 1.02);
}

}  // namespace
}  // namespace krok::gait
