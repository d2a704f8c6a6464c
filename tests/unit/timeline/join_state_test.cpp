// If these fail, an inertial change jumps in value, velocity or acceleration, or swings beyond its
// end.

#include "timeline/join_state.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/quaternion.h"

namespace krok::timeline {
namespace {

TEST(Rates, OfAParabolaAreItsOwn) {
  const Vec3 velocity(1, -2, 3), acceleration(-4, 5, 0.5);
  const auto at = [&](double s) -> Vec3 { return s * velocity + 0.5 * s * s * acceleration; };
  for (const double step : {0.02, -0.02}) {
    const Rates rates = rates_of(at(step), at(2 * step), step, 2);
    EXPECT_LT((rates.velocity - velocity).norm(), 1e-9);
    EXPECT_LT((rates.acceleration - acceleration).norm(), 1e-9);
    const Rates line = rates_of(step * velocity, Vec3::Zero(), step, 1);
    EXPECT_LT((line.velocity - velocity).norm(), 1e-12);
    EXPECT_EQ(line.acceleration, Vec3(Vec3::Zero()));
    EXPECT_EQ(rates_of(at(step), at(step), step, 0).velocity, Vec3(Vec3::Zero()));
  }
}

// By finite differences, the coefficients of which are not the code's.
TEST(Decay, KeepsValueVelocityAndAccelerationAndEndsWithNone) {
  const Vec3 value(0.3, -0.1, 0.02);
  const Rates rates{{1.5, 2, -3}, {-20, 35, 4}};
  const double duration = 0.4, h = 1e-4;
  const Decay decay(value, rates, duration, false);
  EXPECT_EQ(decay.at(0), value);
  const Vec3 first = (-3 * decay.at(0) + 4 * decay.at(h) - decay.at(2 * h)) / (2 * h);
  EXPECT_LT((first - rates.velocity).norm(), 1e-4);
  const Vec3 second =
      (2 * decay.at(0) - 5 * decay.at(h) + 4 * decay.at(2 * h) - decay.at(3 * h)) / (h * h);
  EXPECT_LT((second - rates.acceleration).norm(), 1e-1);
  // With nothing left in three derivatives' worth: of third order at the end.
  EXPECT_LT(decay.at(duration - h).norm(), 1e-9);
  EXPECT_EQ(decay.at(duration), Vec3(Vec3::Zero()));
  EXPECT_EQ(decay.at(duration + 1), Vec3(Vec3::Zero()));
}

TEST(Decay, GuardedDoesNotPassNothing) {
  const double duration = 0.5;
  for (const double velocity : {0.0, -1.0, -4.0, -10.0, -20.0}) {
    for (const double acceleration : {0.0, -30.0, 30.0, -300.0, 300.0}) {
      const Vec3 value(1, 0, 0);
      const Decay guarded(value, {{velocity, 0, 0}, {acceleration, 0, 0}}, duration, true);
      double least = 1, most = 0;
      for (int i = 0; i <= 500; ++i) {
        const double now = guarded.at(duration * i / 500.0).x();
        least = std::min(least, now);
        most = std::max(most, now);
      }
      // A velocity that leads home faster than in a third of the time overshoots a little.
      const bool too_fast = -5 / velocity < duration / 3 && velocity < 0;
      EXPECT_GE(least, too_fast ? -0.2 : -1e-9) << velocity << " " << acceleration;
      EXPECT_LE(most, 1.6) << velocity << " " << acceleration;
      // The velocity at the join stays.
      EXPECT_NEAR((guarded.at(1e-6).x() - 1) / 1e-6, velocity, 1e-3);
    }
  }
  // Without the guard it does.
  const Decay wild({1, 0, 0}, {{-10, 0, 0}, {-300, 0, 0}}, duration, false);
  EXPECT_LT(wild.at(0.15).x(), -0.1);
}

TEST(Decay, OfNothingIsNothing) {
  for (const bool guard : {true, false}) {
    const Decay decay(Vec3::Zero(), {}, 0.3, guard);
    for (const double t : {0.0, 0.1, 0.3}) EXPECT_EQ(decay.at(t), Vec3(Vec3::Zero()));
    EXPECT_EQ(Decay(Vec3(1, 2, 3), {}, 0, guard).at(0), Vec3(Vec3::Zero()));
  }
  // The velocity alone is kept too.
  const Decay moving(Vec3::Zero(), {{2, 0, 0}, {5, 0, 0}}, 0.3, true);
  EXPECT_NEAR(moving.at(1e-6).x() / 1e-6, 2, 1e-3);
}

// Two joints that turn about changing axes: the offset that is worked out from their rates follows
// the one between them.
TEST(RotationOffset, FollowsBothRotations) {
  for (const double apart : {0.0, 1e-9, 0.4, 2.5, kPi - 1e-4, kPi}) {
    const Quat from = from_rotation_vector({0.3, apart, -0.2}) * from_rotation_vector({1, 0, 0.5});
    const Quat to = from_rotation_vector({0.3, 0, -0.2}) * from_rotation_vector({1, 0, 0.5});
    const Rates a{{2, -1, 0.5}, {10, 4, -3}}, b{{-1, 0.5, 2}, {-5, 6, 7}};
    const RotationOffset offset = rotation_offset(from, a, to, b);
    for (const double s : {-5e-3, 4e-3}) {
      const Quat now = from_rotation_vector(a.at(s)) * from;
      const Quat other = from_rotation_vector(b.at(s)) * to;
      const Quat rebuilt = from_rotation_vector(offset.value + offset.rates.at(s)) * other;
      EXPECT_LT(angle_between(now, rebuilt), 3e-5) << apart << " " << s;
    }
  }
}

TEST(VectorVelocity, IsTheDerivativeOfTheRotation) {
  const Vec3 rate(0.7, -1.1, 0.4);
  for (const Vec3& v : {Vec3(0, 0, 0), Vec3(1e-7, 0, 0), Vec3(0.5, 0.2, -0.9), Vec3(2, 1, -1.5)}) {
    const double h = 1e-5;
    const Quat ahead = from_rotation_vector(v + h * vector_velocity(v, rate));
    const Vec3 turned = rotation_vector(ahead * from_rotation_vector(v).conjugate()) / h;
    EXPECT_LT((turned - rate).norm(), 1e-4) << v.transpose();
  }
}

}  // namespace
}  // namespace krok::timeline
