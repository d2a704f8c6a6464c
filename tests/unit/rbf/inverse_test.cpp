// Would fail if the weights found for wanted parameters did not give them, if weights stopped
// summing to 1, or if a measure that fails did harm.

#include "rbf/inverse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "rbf/sobol.h"
#include "rbf/weight_solver.h"
#include "support/arm.h"

namespace krok::rbf {
namespace {

using Values = std::vector<double>;

WeightEvaluator evaluator_of(const test::Arm& arm) {
  const auto solver = WeightSolver::create(arm.dimensions, arm.parameters);
  EXPECT_TRUE(solver.ok());
  auto evaluator = WeightEvaluator::create(solver->function());
  EXPECT_TRUE(evaluator.ok());
  return std::move(*evaluator);
}

Values point_within(const WeightEvaluator& evaluator, std::uint32_t index) {
  Values point(static_cast<std::size_t>(evaluator.dimensions()));
  Sobol(evaluator.dimensions(), 5).point(index, point);
  for (std::size_t i = 0; i < point.size(); ++i) {
    point[i] = evaluator.lower()[i] + point[i] / evaluator.inverse_ranges()[i];
  }
  return point;
}

// How far the parameters of a blend are from wanted ones, by the farthest.
double distance_from(const test::Arm& arm, const Values& weights, const Values& wanted) {
  Values found(wanted.size());
  EXPECT_TRUE(arm.measure()(weights, found, {}).ok());
  double farthest = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    farthest = std::max(farthest, std::abs(found[i] - wanted[i]));
  }
  return farthest;
}

TEST(InverseSearch, TwoStepsComeWithinATenthOfAMillimetre) {
  for (const int d : {1, 2, 3}) {
    const test::Arm arm = test::make_arm(d, 3);
    const WeightEvaluator evaluator = evaluator_of(arm);
    InverseSearch search(evaluator, arm.measure());
    double worst_before = 0;
    for (std::uint32_t p = 0; p < 200; ++p) {
      const Values wanted = point_within(evaluator, p);
      Values weights(static_cast<std::size_t>(evaluator.examples()));
      evaluator.weights(wanted, weights);
      worst_before = std::max(worst_before, distance_from(arm, weights, wanted));
      const Match match = search.correct(wanted, 2, 0, weights);
      EXPECT_LT(distance_from(arm, weights, wanted), 1e-4) << d << " " << p;
      EXPECT_LE(match.after, match.before);
      EXPECT_LE(match.measured, 3);
      EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-12);
    }
    EXPECT_GT(worst_before, 0.005);  // there was something to correct
  }
}

TEST(InverseSearch, FindsThePointWhoseBlendHasWhatIsWanted) {
  const test::Arm arm = test::make_arm(2, 3);
  const WeightEvaluator evaluator = evaluator_of(arm);
  InverseSearch search(evaluator, arm.measure());
  for (std::uint32_t p = 0; p < 50; ++p) {
    const Values wanted = point_within(evaluator, p);
    Values point = wanted, weights(9);
    const Match match = search.find_point(wanted, 30, 1e-10, point);
    evaluator.weights(point, weights);
    EXPECT_LT(match.after, 1e-9);
    EXPECT_LT(distance_from(arm, weights, wanted), 1e-9);
  }
}

TEST(InverseSearch, LeavesGoodWeightsAlone) {
  const test::Arm arm = test::make_arm(2, 3);
  const WeightEvaluator evaluator = evaluator_of(arm);
  InverseSearch search(evaluator, arm.measure());
  const Values wanted = point_within(evaluator, 3);
  Values weights(9);
  evaluator.weights(wanted, weights);
  const Values before = weights;
  EXPECT_EQ(search.correct(wanted, 0, 0, weights).measured, 1);
  EXPECT_EQ(weights, before);
  EXPECT_EQ(search.correct(wanted, 5, 10, weights).measured, 1);  // good enough
  EXPECT_EQ(weights, before);
}

TEST(InverseSearch, WhatCannotBeReachedDoesNoHarm) {
  const test::Arm arm = test::make_arm(2, 3);
  const WeightEvaluator evaluator = evaluator_of(arm);
  InverseSearch search(evaluator, arm.measure());
  for (const Values& wanted : {Values{9, 9}, Values{-3, 0}, Values{0.85, 1.9}}) {
    Values weights(9, 1.0 / 9);
    const Match match = search.correct(wanted, 20, 1e-9, weights);
    EXPECT_LE(match.after, match.before);
    EXPECT_GT(match.after, 0.1);
    EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-9);
    Values point = point_within(evaluator, 1);
    EXPECT_LE(search.find_point(wanted, 20, 1e-9, point).after, 1e9);
    for (std::size_t i = 0; i < 2; ++i) {
      const double scaled = (point[i] - evaluator.lower()[i]) * evaluator.inverse_ranges()[i];
      EXPECT_GE(scaled, -0.5 - 1e-12);
      EXPECT_LE(scaled, 1.5 + 1e-12);
    }
  }
}

TEST(InverseSearch, AMeasureThatFailsOrGivesNoNumbersEndsTheSearch) {
  const test::Arm arm = test::make_arm(2, 3);
  const WeightEvaluator evaluator = evaluator_of(arm);
  const Values wanted = point_within(evaluator, 3);
  const Measure failing = [](auto, auto, auto) -> Status { return Error("no-motion", "no"); };
  const Measure nan = [](auto, std::span<double> out, std::span<double> jacobian) -> Status {
    std::ranges::fill(out, 0.5);
    std::ranges::fill(jacobian, std::numeric_limits<double>::quiet_NaN());
    return {};
  };
  const Measure flat = [](auto, std::span<double> out, std::span<double> jacobian) -> Status {
    std::ranges::fill(out, 0.5);
    std::ranges::fill(jacobian, 0.0);
    return {};
  };
  for (const Measure& measure : {failing, nan, flat}) {
    InverseSearch search(evaluator, measure);
    Values weights(9, 1.0 / 9), point = wanted;
    const Match match = search.correct(wanted, 3, 0, weights);
    EXPECT_EQ(match.after, match.before);
    EXPECT_EQ(weights, Values(9, 1.0 / 9));
    search.find_point(wanted, 5, 0, point);
    EXPECT_EQ(point, wanted);
  }
}

}  // namespace
}  // namespace krok::rbf
