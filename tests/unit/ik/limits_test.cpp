// If these fail, a joint is let out of its range or kept from a part of it, or is clamped to
// another pose than the nearest allowed one, which makes solvers stick and motions jump.

#include "ik/limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "unit/ik/chains.h"

namespace krok::ik {
namespace {

TEST(Limits, AnglesComposeToTheRotationTheyWereMeasuredFrom) {
  test::Dice dice(1);
  for (int i = 0; i < 2000; ++i) {
    const JointLimit limit = dice.cone();
    const Quat q = dice.rotation(2.5);
    const LimitAngles angles = measure(limit, q);
    EXPECT_LT(angle_between(compose(limit, angles.twist, angles.swing), q), 1e-9);
  }
}

TEST(Limits, ClampingLeavesWhatIsInsideAndBringsTheRestToTheBorder) {
  test::Dice dice(2);
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const JointLimit limit = i % 2 == 0 ? dice.cone() : dice.hinge();
    const Quat q = dice.rotation(2.8);
    const Quat allowed = clamped(limit, q);
    EXPECT_LT(excess(limit, allowed), 1e-9);
    if (excess(limit, q) == 0) {
      ++inside;
      EXPECT_EQ(allowed.coeffs(), q.coeffs());
    }
    const LimitAngles angles = measure(limit, allowed);
    EXPECT_GE(angles.twist, limit.min_twist - 1e-9);
    EXPECT_LE(angles.twist, limit.max_twist + 1e-9);
    double square = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double swing = angles.swing[k];
      const double half = swing < 0 ? -limit.min_swing[k] : limit.max_swing[k];
      square += swing * swing / (half * half);
    }
    EXPECT_LE(square, 1 + 1e-9);
  }
  EXPECT_GT(inside, 100);
}

TEST(Limits, NoPointOfTheEllipseIsNearerThanTheClampedOne) {
  test::Dice dice(3);
  for (int i = 0; i < 300; ++i) {
    const JointLimit limit = dice.cone();
    const std::array<double, 2> swing = {dice.between(-3, 3), dice.between(-3, 3)};
    const auto nearest = nearest_swing(limit, swing);
    const double distance = std::hypot(nearest[0] - swing[0], nearest[1] - swing[1]);
    if (distance == 0) continue;
    for (int k = 0; k < 720; ++k) {
      const double angle = k * kPi / 360;
      const double e0 = std::cos(angle) < 0 ? -limit.min_swing[0] : limit.max_swing[0];
      const double e1 = std::sin(angle) < 0 ? -limit.min_swing[1] : limit.max_swing[1];
      EXPECT_GE(std::hypot(e0 * std::cos(angle) - swing[0], e1 * std::sin(angle) - swing[1]),
                distance - 1e-9);
    }
  }
}

// A range of 0 on one side is an ordinary case: a knee does not bend forwards.
TEST(Limits, AnEllipseWithoutWidthKeepsTheOtherAngle) {
  JointLimit limit;
  limit.kind = JointLimit::Kind::cone;
  limit.min_swing = {0, -1};
  limit.max_swing = {0, 1};
  const auto nearest = nearest_swing(limit, {0.3, 0.5});
  EXPECT_NEAR(nearest[0], 0, 1e-8);
  EXPECT_NEAR(nearest[1], 0.5, 1e-6);
}

TEST(Limits, HingesBeyondHalfATurnAreMeasuredFromTheMiddleOfTheirRange) {
  JointLimit limit;
  limit.kind = JointLimit::Kind::hinge;
  limit.axis = Vec3::UnitZ();
  limit.min_twist = -45 * kRadiansPerDegree;
  limit.max_twist = 225 * kRadiansPerDegree;
  for (const double degrees : {-44.0, 0.0, 90.0, 179.0, 181.0, 224.0}) {
    const Quat q(Eigen::AngleAxisd(degrees * kRadiansPerDegree, Vec3::UnitZ()));
    EXPECT_NEAR(measure(limit, q).twist, degrees * kRadiansPerDegree, 1e-9);
    EXPECT_EQ(excess(limit, q), 0) << degrees;
  }
  const Quat beyond(Eigen::AngleAxisd(-60 * kRadiansPerDegree, Vec3::UnitZ()));
  EXPECT_NEAR(measure(limit, clamped(limit, beyond)).twist, limit.min_twist, 1e-9);
}

TEST(Limits, GradientsAreTheChangeOfTheAngles) {
  test::Dice dice(4);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 500; ++i) {
    const JointLimit limit = dice.cone();
    const Quat q = compose(limit, dice.between(-1, 1), {dice.between(-1, 1), dice.between(-1, 1)});
    const LimitGradients found = gradients(limit, q);
    const auto size = [&](const Quat& r) {
      const auto swing = measure(limit, r).swing;
      double sum = 0;
      for (std::size_t k = 0; k < 2; ++k) {
        const double half = swing[k] < 0 ? -limit.min_swing[k] : limit.max_swing[k];
        sum += swing[k] * swing[k] / (half * half);
      }
      return sum;
    };
    for (int k = 0; k < 3; ++k) {
      const Quat more = q * from_rotation_vector(kStep * Vec3::Unit(k));
      const Quat less = q * from_rotation_vector(-kStep * Vec3::Unit(k));
      const double twist = (measure(limit, more).twist - measure(limit, less).twist) / (2 * kStep);
      const double swing = (size(more) - size(less)) / (2 * kStep);
      EXPECT_NEAR(found.twist[k], twist, 1e-6 * (1 + std::abs(twist)));
      EXPECT_NEAR(found.swing[k], swing, 1e-5 * (1 + std::abs(swing) + size(q)));
    }
  }
}

TEST(Limits, FreeAndLockedJointsAreLeftAlone) {
  for (const auto kind : {JointLimit::Kind::free, JointLimit::Kind::locked}) {
    JointLimit limit;
    limit.kind = kind;
    limit.min_twist = limit.max_twist = 0;
    const Quat q = from_rotation_vector(Vec3(1, 2, 0.5));
    EXPECT_EQ(clamped(limit, q).coeffs(), q.coeffs());
  }
}

TEST(Limits, ValuesThatMeanNothingAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  JointLimit good;
  good.kind = JointLimit::Kind::cone;
  EXPECT_TRUE(check(Limits{good}, 1).ok());
  EXPECT_TRUE(check(Limits{}, 5).ok());
  Status count = check(Limits{good}, 2);
  ASSERT_FALSE(count.ok());
  EXPECT_EQ(count.error().code, "limits-count");
  std::vector<JointLimit> bad(7, good);
  bad[0].zero = Quat(0, 0, 0, 0);
  bad[1].axis = Vec3(nan, 0, 0);
  bad[2].swing_axis = Vec3::UnitY();  // along the axis
  bad[3].min_twist = 1, bad[3].max_twist = 0;
  bad[4].max_twist = nan;
  bad[5].min_swing[0] = 0.1;
  bad[6].max_swing[1] = 4;
  for (const JointLimit& limit : bad) {
    Status status = check(Limits{limit}, 1);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().code, "limits-value");
  }
}

}  // namespace
}  // namespace krok::ik
