// If these fail, keyed motion does not go through its keys, jumps in velocity, or swings beyond
// them where it must not.
#include "math/hermite.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace krok {
namespace {

using Doubles = std::vector<double>;

Doubles tension(const Doubles& times, const Doubles& values, double a, Ends ends = Ends::open) {
  Doubles velocities(times.size());
  tension_velocities(times, values, a, ends, velocities);
  return velocities;
}

Doubles monotone(const Doubles& times, const Doubles& values, Ends ends = Ends::open) {
  Doubles velocities(times.size());
  monotone_velocities(times, values, ends, velocities);
  return velocities;
}

void expect_near(const Doubles& found, const Doubles& expected, double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], tolerance) << i;
}

TEST(Hermite, IsTheCubicWithTheseEnds) {
  // p(s) = 2 - 3s + 0.5 s^2 + 0.25 s^3 from s = 1 to s = 3.
  const auto p = [](double s) { return 2 - 3 * s + 0.5 * s * s + 0.25 * s * s * s; };
  const auto v = [](double s) { return -3 + s + 0.75 * s * s; };
  for (const double t : {0.0, 0.1, 0.5, 0.77, 1.0}) {
    EXPECT_NEAR(hermite(p(1), v(1), p(3), v(3), 2, t), p(1 + 2 * t), 1e-13);
    EXPECT_NEAR(hermite_velocity(p(1), v(1), p(3), v(3), 2, t), v(1 + 2 * t), 1e-13);
    const Vec3 unit(1, -2, 0.5);
    const Vec3 vector =
        hermite(Vec3(p(1) * unit), Vec3(v(1) * unit), Vec3(p(3) * unit), Vec3(v(3) * unit), 2, t);
    EXPECT_LT((vector - p(1 + 2 * t) * unit).norm(), 1e-13);
  }
}

TEST(Hermite, AgreesWithScipysCubicHermiteSpline) {
  const Doubles times = {0, 0.5, 2}, values = {1, 3, -1}, velocities = {2, -1, 0.5};
  expect_near(
      {sample_curve(times, values, velocities, 0.2), sample_curve(times, values, velocities, 0.5),
       sample_curve(times, values, velocities, 1.1), sample_curve(times, values, velocities, 1.9)},
      {1.896, 3.0, 1.304, -0.9988148148148159}, 1e-14);
}

TEST(TensionVelocities, AreTheTangentsOfTheFormulaForEvenKeys) {
  // m_i = (1 - a) / 2 ((p_i - p_{i-1}) + (p_{i+1} - p_i)), by the time between keys.
  const Doubles times = {0, 0.25, 0.5, 0.75}, values = {1, 4, -2, 3};
  for (const double a : {0.0, 0.3, 1.0, -0.5}) {
    const auto m = [&](std::size_t i) {
      return (1 - a) / 2 * ((values[i] - values[i - 1]) + (values[i + 1] - values[i]));
    };
    expect_near(tension(times, values, a),
                {(1 - a) * 3 / 0.25, m(1) / 0.25, m(2) / 0.25, (1 - a) * 5 / 0.25}, 1e-12);
  }
}

TEST(TensionVelocities, OfKeysOnALineAreItsSlopeHoweverTheyAreSpaced) {
  const Doubles times = {0, 0.1, 1, 1.5, 4};
  Doubles values;
  for (const double t : times) values.push_back(3 - 2 * t);
  expect_near(tension(times, values, 0), {-2, -2, -2, -2, -2}, 1e-13);
  for (double t = 0; t <= 4; t += 0.1) {
    EXPECT_NEAR(sample_curve(times, values, tension(times, values, 0), t), 3 - 2 * t, 1e-13);
  }
}

TEST(TensionVelocities, MakeAVelocityWithoutJumps) {
  const Doubles times = {0, 0.1, 1, 1.5, 4}, values = {1, 3, -2, 0, 5};
  const Doubles velocities = tension(times, values, 0.2);
  for (std::size_t k = 1; k + 1 < times.size(); ++k) {
    const double step = 1e-6;
    const double before =
        (values[k] - sample_curve(times, values, velocities, times[k] - step)) / step;
    const double after =
        (sample_curve(times, values, velocities, times[k] + step) - values[k]) / step;
    EXPECT_NEAR(before, after, 2e-3) << k;
  }
}

TEST(TensionVelocities, ClosedEndsMeetWithOneVelocity) {
  const Doubles times = {0, 1, 3, 4}, values = {2, 5, 1, 2};
  const Doubles velocities = tension(times, values, 0, Ends::closed);
  EXPECT_EQ(velocities.front(), velocities.back());
  EXPECT_NEAR(velocities.front(), ((2 - 1) + (5 - 2)) / 2.0, 1e-13);
  EXPECT_NEAR(velocities[1], (1 - 2) / 3.0, 1e-13);
  const Doubles slopes = monotone(times, values, Ends::closed);
  EXPECT_EQ(slopes.front(), slopes.back());
  EXPECT_GT(slopes.front(), 0);
}

TEST(TensionVelocities, OfOneKeyIsZeroAndOfTwoTheLine) {
  expect_near(tension({3}, {7}, 0), {0}, 0);
  expect_near(monotone({3}, {7}), {0}, 0);
  expect_near(tension({}, {}, 0), {}, 0);
  expect_near(tension({1, 3}, {7, 1}, 0), {-3, -3}, 1e-14);
  expect_near(monotone({1, 3}, {7, 1}), {-3, -3}, 1e-14);
}

TEST(MonotoneVelocities, AgreeWithScipysPchip) {
  const Doubles times = {0, 0.1, 0.5, 0.6, 1.4, 2.0, 2.1}, values = {0, 1, 1.2, 3.5, 3.5, 2, 2.4};
  const Doubles velocities = monotone(times, values);
  expect_near(
      velocities,
      {11.900000000000002, 1.1627906976744182, 1.2105263157894735, 0, 0, 0, 4.9285714285714235},
      1e-12);
  Doubles found;
  for (const double t : {0.05, 0.3, 0.55, 1.0, 1.7, 2.05}) {
    found.push_back(sample_curve(times, values, velocities, t));
  }
  expect_near(
      found,
      {0.6342151162790697, 1.0976132190942474, 2.36513157894737, 3.5, 2.75, 2.138392857142856},
      1e-13);
  // Ends that the bounds cut off.
  expect_near(monotone({0, 1, 2, 4}, {0, 1, -8, -9}), {3, 0, -1.0519480519480520, 0}, 1e-12);
  expect_near(monotone({0, 1, 2}, {0, 1, 10}), {0, 1.8, 13}, 1e-12);
}

TEST(MonotoneVelocities, NeverSwingBeyondTheKeys) {
  const Doubles times = {0, 0.01, 1, 1.1, 3}, values = {0, 5, 5.1, 9, 9.0001};
  const Doubles velocities = monotone(times, values);
  double before = -1;
  for (double t = 0; t <= 3; t += 1e-3) {
    const double now = sample_curve(times, values, velocities, t);
    EXPECT_GE(now, before - 1e-12) << t;
    before = now;
  }
}

TEST(MonotoneVelocities, OfVectorsGoByCoordinate) {
  const Doubles times = {0, 1, 3, 4};
  const std::vector<Vec3> values = {{0, 1, 2}, {1, 1, 0}, {4, 0, 3}, {5, -1, 3}};
  std::vector<Vec3> velocities(4);
  monotone_velocities(times, values, Ends::open, velocities);
  for (int axis = 0; axis < 3; ++axis) {
    Doubles coordinate, found;
    for (std::size_t i = 0; i < 4; ++i) {
      coordinate.push_back(values[i][axis]);
      found.push_back(velocities[i][axis]);
    }
    expect_near(found, monotone(times, coordinate), 0);
  }
}

TEST(SampleCurve, GivesKeysExactlyAndHoldsTheEnds) {
  const Doubles times = {0.1, 0.7, 0.9}, values = {0.3, 1e9, -0.1}, velocities = {5, 5, 5};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(sample_curve(times, values, velocities, times[k]), values[k]);
  }
  EXPECT_EQ(sample_curve(times, values, velocities, -4), 0.3);
  EXPECT_EQ(sample_curve(times, values, velocities, 4), -0.1);
  EXPECT_EQ(sample_curve(times, values, velocities, std::nan("")), 0.3);
}

TEST(KeyBefore, FindsTheKeyFromAnyGuess) {
  Doubles times;
  for (int i = 0; i < 40; ++i) times.push_back(i * i * 0.01);
  for (double t = -0.5; t < 17; t += 0.093) {
    std::size_t expected = 0;
    while (expected + 1 < times.size() && times[expected + 1] <= t) ++expected;
    for (const std::size_t guess : {0u, 1u, 7u, 20u, 38u, 39u, 40u, 1000u}) {
      EXPECT_EQ(key_before(times, t, guess), expected) << t << " from " << guess;
    }
  }
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_EQ(key_before(times, times[k]), k);
}

}  // namespace
}  // namespace krok
