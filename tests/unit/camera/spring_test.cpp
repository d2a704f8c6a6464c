// If these fail, a following camera swings, lags, or moves otherwise at another frame rate.

#include "camera/look_at.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace krok {
namespace {

TEST(Spring, AnswersAStepAsTheEquationSays) {
  // y'' + 2 w y' + w^2 y = w^2 from rest: 1 - (1 + w t) exp(-w t).
  const double time = 0.8, w = 2 / time;
  for (const double step : {1.0 / 24, 1.0 / 240, 0.5}) {
    SpringState state;
    double t = 0;
    for (int i = 0; i < 12; ++i) {
      state = follow(state, 1, 1, step, time);
      t += step;
      EXPECT_NEAR(state.value, 1 - (1 + w * t) * std::exp(-w * t), 1e-12) << step << " " << i;
      EXPECT_NEAR(state.velocity, w * w * t * std::exp(-w * t), 1e-12) << step << " " << i;
      EXPECT_LE(state.value, 1);
    }
  }
}

TEST(Spring, TrailsBehindEvenMotionByItsTime) {
  const double time = 0.5, step = 0.1;
  SpringState state;
  for (int i = 0; i < 200; ++i)
    state = follow(state, 3.0 * i * step, 3.0 * (i + 1) * step, step, time);
  EXPECT_NEAR(state.value, 3.0 * (200 * step - time), 1e-9);
  EXPECT_NEAR(state.velocity, 3.0, 1e-9);
}

TEST(Spring, OneLongStepIsManyShortOnes) {
  const SpringState start{0.3, -2};
  const SpringState once = follow(start, 1, 2, 0.4, 0.7);
  SpringState bits = start;
  for (int i = 0; i < 8; ++i) {
    bits = follow(bits, 1 + i / 8.0, 1 + (i + 1) / 8.0, 0.05, 0.7);
  }
  EXPECT_NEAR(bits.value, once.value, 1e-12);
  EXPECT_NEAR(bits.velocity, once.velocity, 1e-12);
}

TEST(Spring, WithoutTimeFollowsAtOnce) {
  const SpringState state = follow({0, 0}, 1, 2, 0.5, 0);
  EXPECT_EQ(state.value, 2);
  EXPECT_EQ(state.velocity, 2);
  const SpringState same = follow({3, 4}, 1, 2, 0, 0.5);  // no time passes
  EXPECT_EQ(same.value, 3);
}

// The sum over a kernel w/4 (1 + w|t|) exp(-w|t|) written out.
TEST(SmoothBothWays, IsTheMeanWithItsWeights) {
  const double rate = 400, time = 0.1, w = 2 / time;
  std::vector<double> series(1200);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double t = static_cast<double>(i) / rate;
    series[i] = std::sin(9 * t) + 0.3 * std::cos(31 * t);
  }
  const std::vector<double> before = series;
  smooth_both_ways(series, rate, time);
  for (const std::size_t i : {500u, 600u, 710u}) {
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const double t = std::abs(static_cast<double>(k) - static_cast<double>(i)) / rate;
      const double weight = w / 4 * (1 + w * t) * std::exp(-w * t) / rate;
      sum += weight * before[k];
      weights += weight;
    }
    EXPECT_NEAR(weights, 1, 1e-5);
    EXPECT_NEAR(series[i], sum, 2e-4);
    EXPECT_GT(std::abs(series[i] - before[i]), 2e-3);
  }
}

TEST(SmoothBothWays, DoesNotOvershootAJumpAndIsSymmetric) {
  std::vector<double> jump(401, 0.0);
  std::fill(jump.begin() + 201, jump.end(), 1.0);
  jump[200] = 0.5;
  smooth_both_ways(jump, 60, 0.2);
  for (std::size_t i = 0; i < jump.size(); ++i) {
    EXPECT_GE(jump[i], -1e-4);
    EXPECT_LE(jump[i], 1 + 1e-4);
    if (i > 0) {
      EXPECT_GE(jump[i], jump[i - 1] - 1e-4);
    }
    EXPECT_NEAR(jump[i] + jump[400 - i], 1, 1e-3);  // no shift in time
  }
  EXPECT_GT(jump[190], 0.05);
}

TEST(SmoothBothWays, KeepsEvenMotionToItsEndsAndShortSeries) {
  std::vector<Vec3> path;
  for (int i = 0; i < 50; ++i) path.emplace_back(0.1 * i, 2, -0.3 * i);
  const std::vector<Vec3> before = path;
  smooth_both_ways(path, 30, 1.0);
  for (std::size_t i = 0; i < path.size(); ++i) EXPECT_LT((path[i] - before[i]).norm(), 1e-9) << i;
  for (const std::size_t size : {0u, 1u, 2u}) {
    std::vector<Vec3> few(before.begin(), before.begin() + static_cast<std::ptrdiff_t>(size));
    smooth_both_ways(few, 30, 1.0);
    for (std::size_t i = 0; i < size; ++i) EXPECT_EQ(few[i], before[i]);
  }
  std::vector<double> same = {1, 5, 2};
  smooth_both_ways(same, 30, 0);
  EXPECT_EQ(same, (std::vector<double>{1, 5, 2}));
}

TEST(SmoothBothWays, IsTheSameAtEveryFrameRate) {
  const auto smoothed_at = [](double rate, double moment) {
    std::vector<Vec3> path;
    for (int i = 0; i <= static_cast<int>(4 * rate); ++i) {
      const double t = i / rate;
      path.emplace_back(std::sin(2 * t), t * t, std::cos(5 * t));
    }
    smooth_both_ways(path, rate, 0.3);
    return path[static_cast<std::size_t>(moment * rate)];
  };
  for (const double moment : {0.5, 2.0, 3.0}) {
    EXPECT_LT((smoothed_at(30, moment) - smoothed_at(240, moment)).norm(), 3e-3) << moment;
  }
}

}  // namespace
}  // namespace krok
