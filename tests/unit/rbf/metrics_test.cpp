// Would fail if Sobol's sequence were another than everybody's, or if the figures about weights
// were not what closed forms say.

#include "rbf/weight_function.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "rbf/sobol.h"
#include "rbf/weight_solver.h"

namespace krok::rbf {
namespace {

using Values = std::vector<double>;

TEST(Sobol, IsTheSequenceOfScipy) {
  // scipy 1.10.1, stats.qmc.Sobol(8, scramble=False).
  const struct {
    std::uint32_t index;
    Values point;
  } expected[] = {
      {0, {0, 0, 0, 0, 0, 0, 0, 0}},
      {1, {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}},
      {2, {0.75, 0.25, 0.25, 0.25, 0.75, 0.75, 0.25, 0.75}},
      {3, {0.25, 0.75, 0.75, 0.75, 0.25, 0.25, 0.75, 0.25}},
      {5, {0.875, 0.875, 0.125, 0.375, 0.875, 0.625, 0.875, 0.375}},
      {37, {0.921875, 0.640625, 0.578125, 0.921875, 0.765625, 0.296875, 0.171875, 0.796875}},
      {511,
       {0.001953125, 0.501953125, 0.408203125, 0.845703125, 0.353515625, 0.876953125, 0.744140625,
        0.462890625}},
      {1000,
       {0.2197265625, 0.0966796875, 0.5185546875, 0.6767578125, 0.2802734375, 0.9072265625,
        0.0458984375, 0.8994140625}}};
  const Sobol sobol(8);
  for (const auto& e : expected) {
    Values point(8);
    sobol.point(e.index, point);
    EXPECT_EQ(point, e.point) << e.index;
  }
}

TEST(Sobol, FillsTheCubeEvenlyWithEverySeed) {
  Values first_points;
  for (const std::uint64_t seed : {0u, 1u, 2u, 77u}) {
    for (int d = 1; d <= kMaxDimensions; ++d) {
      const Sobol sobol(d, seed);
      // 256 points have one in each of 256 parts of every axis.
      std::vector<std::set<int>> parts(static_cast<std::size_t>(d));
      Values point(static_cast<std::size_t>(d));
      for (std::uint32_t p = 0; p < 256; ++p) {
        sobol.point(p, point);
        for (std::size_t i = 0; i < point.size(); ++i) {
          EXPECT_GE(point[i], 0);
          EXPECT_LT(point[i], 1);
          parts[i].insert(static_cast<int>(point[i] * 256));
        }
      }
      for (const auto& part : parts) EXPECT_EQ(part.size(), 256u);
      sobol.point(0, point);
      if (d == 1) first_points.push_back(point[0]);
    }
  }
  EXPECT_EQ(std::set<double>(first_points.begin(), first_points.end()).size(), 4u);
}

TEST(WeightMetrics, AreThoseOfTheNaturalSpline) {
  // Over x in [0, 2], which is the range: the middle weight is 1.5 x - 0.5 x^3 up to 1, its second
  // derivative by x / 2 is -12 x, and half of it with the other sign the others'. The mean of
  // (144 + 36 + 36) x^2 over half the range is 72.
  const auto solver = WeightSolver::create(1, Values{0, 1, 2});
  ASSERT_TRUE(solver.ok());
  const auto metrics = weight_metrics(solver->function(), 4096);
  ASSERT_TRUE(metrics.ok());
  EXPECT_NEAR(metrics->roughness, 72, 0.6);
  EXPECT_NEAR(metrics->largest, 1, 1e-12);
  // An outer weight, 1 - x / 2 less half of the middle one, is least at x = 2 - sqrt(1 / 3).
  const double u = std::sqrt(1.0 / 3);
  EXPECT_NEAR(metrics->least, u / 2 - (1.5 * u - 0.5 * u * u * u) / 2, 1e-5);
  EXPECT_LT(metrics->sum_error, 1e-14);
}

TEST(WeightMetrics, PlanesAreNotRough) {
  const auto solver = WeightSolver::create(2, Values{0, 0, 3, 0, 0, 2});
  ASSERT_TRUE(solver.ok());
  const auto metrics = weight_metrics(solver->function());
  ASSERT_TRUE(metrics.ok());
  EXPECT_LT(metrics->roughness, 1e-20);
  // Beyond the hypotenuse the first weight is negative.
  EXPECT_NEAR(metrics->least, -1, 0.05);
  EXPECT_EQ(weight_metrics(WeightFunction()).ok(), false);
}

}  // namespace
}  // namespace krok::rbf
