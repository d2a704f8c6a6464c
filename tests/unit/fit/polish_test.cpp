// Would fail if polishing did not make what is between inserted points better, moved what examples
// have, made weights worse, could not be gone on from, or believed a motion that misleads it.

#include "fit/polish.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/simd.h"
#include "rbf/weight_evaluator.h"
#include "refinement.h"

namespace krok::fit {
namespace {

using namespace test;

Refined polished(const Refined& start, const rbf::Measure& measure, const RefineOptions& options) {
  auto result = polish(start, measure, options);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? *std::move(result) : Refined{};
}

// On a lattice, which is neither what rows are fitted to nor what is held out.
struct LatticeErrors {
  double mean = 0, largest = 0;
};
LatticeErrors lattice_errors(const Refined& refined, const rbf::Measure& measure) {
  constexpr int kSteps = 21;
  const rbf::WeightFunction& f = refined.function;
  const auto d = static_cast<std::size_t>(f.dimensions);
  const auto evaluator = rbf::WeightEvaluator::create(f);
  EXPECT_TRUE(evaluator.ok());
  Values point(d), found(d), weights(static_cast<std::size_t>(f.examples));
  LatticeErrors errors;
  const int count = static_cast<int>(std::pow(kSteps, f.dimensions));
  for (int p = 0; p < count; ++p) {
    for (std::size_t a = 0, rest = static_cast<std::size_t>(p); a < d; ++a, rest /= kSteps) {
      const double place = static_cast<double>(rest % kSteps) / (kSteps - 1);
      point[a] = f.lower[a] + place * (f.upper[a] - f.lower[a]);
    }
    evaluator->weights(point, weights);
    EXPECT_TRUE(measure(weights, found, {}).ok());
    double square = 0;
    for (std::size_t a = 0; a < d; ++a) {
      square += std::pow((found[a] - point[a]) * evaluator->inverse_ranges()[a], 2);
    }
    errors.largest = std::max(errors.largest, std::sqrt(square));
    errors.mean += std::sqrt(square) / count;
  }
  return errors;
}

TEST(Polish, BringsDownTheErrorBetweenPoints) {
  for (const auto& [dimensions, points] : {std::pair{2, 20}, {2, 80}, {3, 40}}) {
    const Arm arm = make_arm(dimensions, 3);
    const RefineOptions options = with_points(points);
    const Refined found = refined(start_of(arm), arm.measure(), options);
    const Refined better = polished(found, arm.measure(), options);
    ASSERT_TRUE(better.polished);
    const LatticeErrors before = lattice_errors(found, arm.measure());
    const LatticeErrors after = lattice_errors(better, arm.measure());
    EXPECT_LT(after.mean, 0.8 * before.mean) << dimensions << " " << points;
    EXPECT_LT(after.largest, 1.05 * before.largest) << dimensions << " " << points;
    const RefineMetrics &was = found.rounds.back().after, &now = better.polished->after;
    EXPECT_LT(now.mean_square, 0.7 * was.mean_square);
    EXPECT_LE(now.largest, was.largest);
    EXPECT_GE(now.least_weight, -0.15);
    EXPECT_LE(now.roughness, 1.1 * found.before.roughness);
    // All else is as it was.
    EXPECT_EQ(better.polished->found_rows, found.function.inserted_rows);
    EXPECT_EQ(better.function.centres, found.function.centres);
    EXPECT_EQ(better.rounds, found.rounds);
  }
}

TEST(Polish, ExamplesComeBackAndWeightsSumToOne) {
  const Arm arm = make_arm(2, 3);
  const RefineOptions options = with_points(40);
  const Refined result =
      polished(refined(start_of(arm), arm.measure(), options), arm.measure(), options);
  ASSERT_TRUE(result.polished);
  const auto evaluator = rbf::WeightEvaluator::create(result.function);
  ASSERT_TRUE(evaluator.ok());
  Values weights(9);
  for (int i = 0; i < 9; ++i) {
    evaluator->weights(result.function.centre(i), weights);
    for (int j = 0; j < 9; ++j) {
      EXPECT_NEAR(weights[static_cast<std::size_t>(j)], i == j ? 1 : 0, 1e-9);
    }
  }
  for (const double place : {0.03, 0.4, 0.77, 1.2}) {
    const Values point = {result.function.lower[0] + place * 0.3, result.function.lower[1] + place};
    evaluator->weights(point, weights);
    EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-12);
  }
}

TEST(Polish, EveryKernelAndSmoothedWeightsGain) {
  const Arm arm = make_arm(2, 3);
  const RefineOptions options = with_points(30);
  const auto expect_gain = [&](const Refined& start, const char* what) {
    const Refined found = refined(start, arm.measure(), options);
    const Refined better = polished(found, arm.measure(), options);
    ASSERT_TRUE(better.polished) << what;
    EXPECT_LT(better.polished->after.mean_square, found.rounds.back().after.mean_square) << what;
  };
  for (const rbf::Kernel kernel : {rbf::Kernel::cubic, rbf::Kernel::linear, rbf::Kernel::gaussian,
                                   rbf::Kernel::bspline, rbf::Kernel::wendland}) {
    expect_gain(start_of(arm, kernel), rbf::kernel_name(kernel).data());
  }
  const auto smoothed =
      rbf::WeightSolver::create(arm.dimensions, arm.parameters, {rbf::Kernel::cubic, {}, {}, 0.05});
  ASSERT_TRUE(smoothed.ok());
  Refined start;
  start.function = smoothed->function();
  expect_gain(start, "smoothed");
}

TEST(Polish, GivesTheSameWithAnyNumberOfThreadsAndAnyInstructions) {
  const Arm arm = make_arm(3, 3);
  RefineOptions options = with_points(30);
  const Refined found = refined(start_of(arm), arm.measure(), options);
  options.jobs = 1;
  const Refined alone = polished(found, arm.measure(), options);
  ASSERT_TRUE(alone.polished);
  for (const int jobs : {2, 5}) {
    options.jobs = jobs;
    EXPECT_EQ(polished(found, arm.measure(), options), alone) << jobs;
  }
  for (const Simd simd : {Simd::other, Simd::avx2}) {
    limit_simd(simd);
    EXPECT_EQ(polished(found, arm.measure(), options), alone);
  }
  limit_simd(Simd::avx512);
}

// Refinement takes up the rows that it found, so that it does not matter when it was stopped.
TEST(Polish, RefinementGoesOnAsIfNothingHadBeenPolished) {
  const Arm arm = make_arm(2, 3);
  const Refined whole = refined(start_of(arm), arm.measure(), with_points(30));
  RefineOptions options = with_points(30);
  options.rounds = 3;
  const Refined found = refined(start_of(arm), arm.measure(), options);
  const Refined part = polished(found, arm.measure(), options);
  ASSERT_TRUE(part.polished);
  EXPECT_EQ(polished(part, arm.measure(), options), part);
  EXPECT_EQ(refined(part, arm.measure(), with_points(found.function.inserted())).function,
            found.function);
  const Refined gone_on = refined(part, arm.measure(), with_points(30));
  EXPECT_FALSE(gone_on.polished);
  EXPECT_EQ(gone_on, whole);
}

TEST(Polish, LeavesAloneWhatItCannotMakeBetter) {
  const Arm arm = make_arm(2, 3);
  const RefineOptions options = with_points(20);
  EXPECT_EQ(polished(start_of(arm), arm.measure(), options), start_of(arm));  // no points
  const Refined found = refined(start_of(arm), arm.measure(), options);
  const rbf::Measure misleading = [&arm](std::span<const double> w, std::span<double> out,
                                         std::span<double> jacobian) -> Status {
    Status status = arm.measure()(w, out, jacobian);
    for (double& slope : jacobian) slope = -slope;
    return status;
  };
  EXPECT_EQ(polished(found, misleading, options), found);
  const rbf::Measure nowhere = [](std::span<const double>, std::span<double>,
                                  std::span<double>) -> Status {
    return Error("blend-interval", "too short");
  };
  EXPECT_EQ(polished(found, nowhere, options), found);
}

TEST(Polish, MissesNoToleranceThatWasMet) {
  // The second parameter is a sum: found rows have it exactly, others need not.
  const Arm arm = make_arm(2, 3);
  const rbf::Measure half_straight = [&arm](std::span<const double> w, std::span<double> out,
                                            std::span<double> jacobian) -> Status {
    if (Status status = arm.measure()(w, out, jacobian); !status) return status;
    out[1] = 0;
    for (std::size_t i = 0; i < w.size(); ++i) {
      out[1] += w[i] * arm.parameters[2 * i + 1];
      if (!jacobian.empty()) jacobian[w.size() + i] = arm.parameters[2 * i + 1];
    }
    return {};
  };
  RefineOptions options = with_points(30);
  const Refined found = refined(start_of(arm), half_straight, options);
  const Refined freely = polished(found, half_straight, options);
  ASSERT_TRUE(freely.polished);
  const double exactly = found.rounds.back().after.within[1].largest;
  ASSERT_GT(freely.polished->after.within[1].largest, exactly);
  options.tolerance = {1, exactly};
  const Refined bound = polished(found, half_straight, options);
  EXPECT_FALSE(bound.polished);
  options.tolerance = {1, freely.polished->after.within[1].largest};
  EXPECT_EQ(polished(found, half_straight, options).polished, freely.polished);
}

TEST(Polish, WorksWhereSomePointsHaveNoMotion) {
  const Arm arm = make_arm(2, 3);
  const rbf::Measure partial = [&arm](std::span<const double> w, std::span<double> out,
                                      std::span<double> jacobian) -> Status {
    if (w[8] > 0.6 && w[8] < 0.9) return Error("blend-interval", "too short");
    return arm.measure()(w, out, jacobian);
  };
  const RefineOptions options = with_points(20);
  const Refined found = refined(start_of(arm), partial, options);
  ASSERT_GT(found.before.failed, 0);
  const Refined better = polished(found, partial, options);
  ASSERT_TRUE(better.polished);
  EXPECT_LE(better.polished->after.failed, found.rounds.back().after.failed);
}

TEST(Polish, TooManyPointsAreLeftAsFound) {
  const Arm arm = make_arm(1, 4);
  Refined many = start_of(arm);
  rbf::WeightFunction& f = many.function;
  for (int k = 0; k <= kMaxPolished; ++k) {
    f.centres.push_back(f.lower[0] + (f.upper[0] - f.lower[0]) * (k + 0.5) / kMaxPolished);
    f.inserted_rows.insert(f.inserted_rows.end(), {1, 0, 0, 0});
    f.coefficients.insert(f.coefficients.end(), 4, 0.0);
  }
  ASSERT_TRUE(f.check().ok()) << f.check().error().message;
  EXPECT_EQ(polished(many, arm.measure(), {}), many);
}

TEST(Polish, WhatIsNoFunctionIsAnError) {
  const auto result = polish(Refined{}, make_arm(2, 3).measure(), {});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, "rbf-dimensions");
}

}  // namespace
}  // namespace krok::fit
