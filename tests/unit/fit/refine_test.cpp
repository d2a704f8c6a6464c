// Would fail if refinement did not bring the error down as far as it should, spoilt the weights, or
// depended on the number of threads or on being interrupted.

#include "fit/refine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/simd.h"
#include "refinement.h"

namespace krok::fit {
namespace {

using namespace test;

// Metres: the arm's hand and elbow.
TEST(Refine, TwoDimensionsReachTwoMillimetresAndThreeTenths) {
  const Arm arm = make_arm(2, 3);
  const Refined result = refined(start_of(arm), arm.measure(), with_points(80));
  EXPECT_EQ(result.stop, Stop::points);
  EXPECT_EQ(result.function.inserted(), 80);
  EXPECT_GT(result.before.within[0].largest, 0.005);
  EXPECT_LT(error_at(result, 20), 0.002);
  EXPECT_LT(error_at(result, 80), 0.0003);
  expect_good_weights(result);
}

TEST(Refine, ThreeDimensionsReachFiveMillimetresAndOne) {
  const Arm arm = make_arm(3, 3);
  const Refined result = refined(start_of(arm), arm.measure(), with_points(160));
  EXPECT_EQ(result.function.inserted(), 160);
  EXPECT_GT(result.before.within[0].largest, 0.01);
  EXPECT_LT(error_at(result, 40), 0.005);
  EXPECT_LT(error_at(result, 160), 0.001);
  expect_good_weights(result);
}

// Between five examples in a row a cubic swings to -0.165 (numpy, by its definition).
TEST(Refine, BringsUpWeightsThatAreTooLow) {
  const Arm arm = make_arm(1, 5);
  const Refined result = refined(start_of(arm), arm.measure(), with_points(20));
  EXPECT_LT(result.before.least_weight, -0.155);
  EXPECT_GE(result.rounds.back().after.least_weight, -0.15);
  EXPECT_LT(10 * error_at(result, 20), result.before.within[0].largest);
  // Low weights alone are mended where errors are small enough, and then it ends.
  RefineOptions content = with_points(20);
  content.tolerance.assign(1, 1);
  const Refined mended = refined(start_of(arm), arm.measure(), content);
  EXPECT_EQ(mended.stop, Stop::tolerance);
  EXPECT_GT(mended.function.inserted(), 0);
  EXPECT_LE(mended.function.inserted(), 8);
  EXPECT_GE(mended.rounds.back().after.least_weight, -0.15);
  content.lowest = -1;
  EXPECT_EQ(refined(start_of(arm), arm.measure(), content).function.inserted(), 0);
}

TEST(Refine, GoesOnUntilItGainedEnough) {
  const Arm arm = make_arm(2, 3);
  RefineOptions options = with_points(80);
  options.tolerance.assign(2, 1);
  EXPECT_EQ(refined(start_of(arm), arm.measure(), options).function.inserted(), 0);
  options.gain = 10;
  const Refined gained = refined(start_of(arm), arm.measure(), options);
  EXPECT_EQ(gained.stop, Stop::tolerance);
  for (std::size_t d = 0; d < 2; ++d) {
    EXPECT_LE(10 * gained.rounds.back().after.within[d].largest, gained.before.within[d].largest);
  }
}

// The examples are not met, what is asked for is.
TEST(Refine, RefinesSmoothedWeights) {
  const Arm arm = make_arm(2, 3);
  const auto solver =
      rbf::WeightSolver::create(arm.dimensions, arm.parameters, {rbf::Kernel::cubic, {}, {}, 0.05});
  ASSERT_TRUE(solver.ok());
  Refined start;
  start.function = solver->function();
  const Refined result = refined(start, arm.measure(), with_points(80));
  EXPECT_EQ(result.function.smoothing, 0.05);
  EXPECT_GT(result.example_error, 1e-4);
  EXPECT_LT(10 * error_at(result, 80), result.before.within[0].largest);
}

TEST(Refine, OneAndFourDimensionsComeDown) {
  const Arm line = make_arm(1, 4);
  const Refined one = refined(start_of(line), line.measure(), with_points(16));
  EXPECT_LT(30 * one.rounds.back().after.largest, one.before.largest);

  const Arm arm = make_arm(4, 2);
  const Refined four = refined(start_of(arm), arm.measure(), with_points(32));
  EXPECT_EQ(four.function.inserted(), 32);
  EXPECT_LT(100 * four.rounds.back().after.mean_square, four.before.mean_square);
}

TEST(Refine, EveryKernelComesDown) {
  const Arm arm = make_arm(2, 3);
  for (const rbf::Kernel kernel : {rbf::Kernel::cubic, rbf::Kernel::linear, rbf::Kernel::gaussian,
                                   rbf::Kernel::bspline, rbf::Kernel::wendland}) {
    const Refined result = refined(start_of(arm, kernel), arm.measure(), with_points(60));
    EXPECT_LT(10 * result.rounds.back().after.largest, result.before.largest)
        << rbf::kernel_name(kernel);
  }
}

TEST(Refine, InsertedPointsHaveTheParametersAskedFor) {
  const Arm arm = make_arm(2, 3);
  const Refined result = refined(start_of(arm), arm.measure(), with_points(24));
  Values found(2);
  for (int k = 0; k < result.function.inserted(); ++k) {
    const auto wanted = result.function.centre(9 + k);
    ASSERT_TRUE(arm.measure()(result.function.inserted_row(k), found, {}).ok());
    EXPECT_NEAR(found[0], wanted[0], 1e-6);
    EXPECT_NEAR(found[1], wanted[1], 1e-6);
  }
}

TEST(Refine, GivesTheSameWithAnyNumberOfThreadsAndAnyInstructions) {
  const Arm arm = make_arm(3, 3);
  RefineOptions options = with_points(30);
  options.jobs = 1;
  const Refined alone = refined(start_of(arm), arm.measure(), options);
  for (const int jobs : {2, 5}) {
    options.jobs = jobs;
    EXPECT_EQ(refined(start_of(arm), arm.measure(), options), alone) << jobs;
  }
  // Nor do the machine's instructions matter.
  for (const Simd simd : {Simd::other, Simd::avx2}) {
    limit_simd(simd);
    EXPECT_EQ(refined(start_of(arm), arm.measure(), options), alone);
  }
  limit_simd(Simd::avx512);
  options.seed = 2;
  EXPECT_NE(refined(start_of(arm), arm.measure(), options), alone);
}

TEST(Refine, GoesOnAsIfItHadNotStopped) {
  const Arm arm = make_arm(2, 3);
  for (const rbf::Kernel kernel : {rbf::Kernel::cubic, rbf::Kernel::bspline}) {
    const Refined whole = refined(start_of(arm, kernel), arm.measure(), with_points(30));
    RefineOptions options = with_points(30);
    options.rounds = 1;
    Refined part = start_of(arm, kernel);
    do {
      part = refined(part, arm.measure(), options);
    } while (part.stop == Stop::rounds);
    EXPECT_EQ(part, whole);
    // Nothing is left to do.
    EXPECT_EQ(refined(part, arm.measure(), options), whole);
  }
}

TEST(Refine, StopsAtTheTolerance) {
  const Arm arm = make_arm(2, 3);
  RefineOptions options = with_points(80);
  options.tolerance = {0.002, 0.001};
  const Refined result = refined(start_of(arm), arm.measure(), options);
  EXPECT_EQ(result.stop, Stop::tolerance);
  EXPECT_LT(result.function.inserted(), 40);
  EXPECT_LE(result.rounds.back().after.within[0].largest, 0.002);
  EXPECT_LE(result.rounds.back().after.within[1].largest, 0.001);
  options.tolerance = {1, 1};
  EXPECT_TRUE(refined(start_of(arm), arm.measure(), options).rounds.empty());
}

TEST(Refine, TellsHowFarItIs) {
  struct Counter : Progress {
    std::uint64_t total = 0, steps = 0;
    int ends = 0;
    void begin(std::string_view, std::uint64_t all) override { total = all; }
    void advance(std::uint64_t more) override { steps += more; }
    void end() override { ++ends; }
  } counter;
  const Arm arm = make_arm(2, 3);
  ASSERT_TRUE(refine(start_of(arm), arm.measure(), with_points(10), counter).ok());
  EXPECT_EQ(counter.total, 10u);
  EXPECT_EQ(counter.steps, 10u);
  EXPECT_EQ(counter.ends, 1);
}

TEST(Refine, NamesItsReasons) {
  EXPECT_EQ(refusal_name(Refusal::weights), "weights");
  EXPECT_EQ(refusal_name(Refusal::growth), "growth");
  EXPECT_EQ(stop_name(Stop::none), "none");
  EXPECT_EQ(stop_name(Stop::exact), "exact");
  EXPECT_EQ(stop_name(Stop::stalled), "stalled");
}

}  // namespace
}  // namespace krok::fit
