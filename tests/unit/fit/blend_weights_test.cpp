// Would fail if the weights that Ceres finds were not the least of what refine.h says, if they did
// not sum to 1, or if anything were printed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "fit/joint_rows_internal.h"
#include "support/arm.h"

namespace krok::fit::detail {
namespace {

using Values = std::vector<double>;

// What is to be least, with y as the distance from the start.
double cost(const rbf::Measure& measure, double range, double wanted, const Values& start,
            const Values& w, const RefineOptions& o) {
  Values found(1);
  EXPECT_TRUE(measure(w, found, {}).ok());
  double sum = std::pow((found[0] - wanted) / range / o.scale, 2);
  for (std::size_t i = 0; i < w.size(); ++i) {
    sum += o.stay * o.stay * std::pow(w[i] - start[i], 2);
    sum += std::pow(o.positive * std::max(0.0, -w[i] - o.slack), 2);
  }
  return sum;
}

TEST(BlendWeights, AreTheLeastOfAllAround) {
  const rbf::Measure curved = [](std::span<const double> w, std::span<double> out,
                                 std::span<double> jacobian) -> Status {
    out[0] = 2 * w[0] + 0.5 * w[1] * w[2] - w[2];
    if (!jacobian.empty()) jacobian[0] = 2, jacobian[1] = 0.5 * w[2], jacobian[2] = 0.5 * w[1] - 1;
    return {};
  };
  const double range = 2;
  const RefineOptions options;
  const Values start = {0.2, 0.05, 0.75};
  for (const double wanted : {0.4, 1.7, -0.9, -1.5}) {
    const BlendWeights best =
        solve_weights(curved, Values{1 / range}, Values{wanted}, start, options);
    EXPECT_NEAR(std::accumulate(best.weights.begin(), best.weights.end(), 0.0), 1, 1e-14);
    const double least = cost(curved, range, wanted, start, best.weights, options);
    EXPECT_LT(least, cost(curved, range, wanted, start, start, options));
    for (int direction = 0; direction < 24; ++direction) {
      for (const double step : {1e-4, 1e-2}) {
        const double a = step * std::cos(direction * 0.2618),
                     b = step * std::sin(direction * 0.2618);
        const Values other = {best.weights[0] + a, best.weights[1] + b, best.weights[2] - a - b};
        EXPECT_GE(cost(curved, range, wanted, start, other, options), least) << wanted;
      }
    }
    Values found(1);
    ASSERT_TRUE(curved(best.weights, found, {}).ok());
    EXPECT_NEAR(best.error, std::abs(found[0] - wanted) / range, 1e-15);
    EXPECT_LT(best.error, 2e-3);
  }
}

TEST(BlendWeights, StayAboveTheSlackWhereTheyCan) {
  const test::Arm arm = test::make_arm(2, 3);
  const Values start(9, 1.0 / 9), scales = {1 / 0.4, 1 / 0.4};
  RefineOptions options;
  const BlendWeights kept = solve_weights(arm.measure(), scales, Values{0.7, 0.52}, start, options);
  EXPECT_LT(kept.error, 1e-3);
  EXPECT_GE(*std::ranges::min_element(kept.weights), -0.06);
  options.positive = 0;
  const BlendWeights free = solve_weights(arm.measure(), scales, Values{0.7, 0.52}, start, options);
  EXPECT_LT(*std::ranges::min_element(free.weights), *std::ranges::min_element(kept.weights));
}

TEST(BlendWeights, AMeasureThatFailsIsSaidWithoutPrinting) {
  const rbf::Measure failing = [](auto, auto, auto) -> Status { return Error("no-motion", "no"); };
  const rbf::Measure nan = [](auto, std::span<double> out, std::span<double> jacobian) -> Status {
    std::ranges::fill(out, std::numeric_limits<double>::quiet_NaN());
    std::ranges::fill(jacobian, std::numeric_limits<double>::infinity());
    return {};
  };
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  for (const rbf::Measure& measure : {failing, nan}) {
    const BlendWeights none =
        solve_weights(measure, Values{1}, Values{0.3}, Values{0.5, 0.5}, RefineOptions{});
    EXPECT_EQ(none.error, std::numeric_limits<double>::infinity());
    EXPECT_EQ(none.weights, (Values{0.5, 0.5}));
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace krok::fit::detail
