// Would fail if refinement did not bring the error down as far as it should, spoilt the weights,
// depended on the number of threads or on being interrupted, or let a bad point in.

#include "fit/refine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "core/simd.h"
#include "rbf/weight_solver.h"
#include "support/arm.h"

namespace krok::fit {
namespace {

using Values = std::vector<double>;

Refined start_of(int dimensions, const Values& parameters,
                 rbf::Kernel kernel = rbf::Kernel::cubic) {
  const auto solver = rbf::WeightSolver::create(dimensions, parameters, {kernel, {}, {}});
  EXPECT_TRUE(solver.ok()) << solver.error().message;
  Refined start;
  start.function = solver->function();
  return start;
}
Refined start_of(const test::Arm& arm, rbf::Kernel kernel = rbf::Kernel::cubic) {
  return start_of(arm.dimensions, arm.parameters, kernel);
}

Refined refined(const Refined& start, const rbf::Measure& measure, const RefineOptions& options) {
  Progress quiet;
  auto result = refine(start, measure, options, quiet);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? std::move(*result) : Refined{};
}

RefineOptions with_points(int points) {
  RefineOptions options;
  options.points = points;
  return options;
}

// The largest error of any parameter after the last round that had at most so many points.
double error_at(const Refined& refined, int points) {
  double error = std::numeric_limits<double>::infinity();
  int inserted = 0;
  for (const RefineRound& round : refined.rounds) {
    inserted += round.inserted;
    if (inserted > points) break;
    error = 0;
    for (const ParameterError& e : round.after.within) error = std::max(error, e.largest);
  }
  return error;
}

void expect_good_weights(const Refined& refined) {
  const RefineFigures& last = refined.rounds.back().after;
  EXPECT_GE(last.least_weight, -0.15);
  EXPECT_LE(last.roughness, 1.1 * refined.before.roughness);
  EXPECT_LT(refined.example_error, 1e-9);
}

// Metres: the arm's hand and elbow.
TEST(Refine, TwoDimensionsReachTwoMillimetresAndThreeTenths) {
  const test::Arm arm = test::make_arm(2, 3);
  const Refined result = refined(start_of(arm), arm.measure(), with_points(80));
  EXPECT_EQ(result.stop, Stop::points);
  EXPECT_EQ(result.function.inserted(), 80);
  EXPECT_GT(result.before.within[0].largest, 0.005);
  EXPECT_LT(error_at(result, 20), 0.002);
  EXPECT_LT(error_at(result, 80), 0.0003);
  expect_good_weights(result);
}

TEST(Refine, ThreeDimensionsReachFiveMillimetresAndOne) {
  const test::Arm arm = test::make_arm(3, 3);
  const Refined result = refined(start_of(arm), arm.measure(), with_points(160));
  EXPECT_EQ(result.function.inserted(), 160);
  EXPECT_GT(result.before.within[0].largest, 0.01);
  EXPECT_LT(error_at(result, 40), 0.005);
  EXPECT_LT(error_at(result, 160), 0.001);
  expect_good_weights(result);
}

// Between five examples in a row a cubic swings to -0.165 (numpy, by its definition).
TEST(Refine, BringsUpWeightsThatAreTooLow) {
  const test::Arm arm = test::make_arm(1, 5);
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
  const test::Arm arm = test::make_arm(2, 3);
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
  const test::Arm arm = test::make_arm(2, 3);
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
  const test::Arm line = test::make_arm(1, 4);
  const Refined one = refined(start_of(line), line.measure(), with_points(16));
  EXPECT_LT(30 * one.rounds.back().after.largest, one.before.largest);

  const test::Arm arm = test::make_arm(4, 2);
  const Refined four = refined(start_of(arm), arm.measure(), with_points(32));
  EXPECT_EQ(four.function.inserted(), 32);
  EXPECT_LT(100 * four.rounds.back().after.mean_square, four.before.mean_square);
}

TEST(Refine, EveryKernelComesDown) {
  const test::Arm arm = test::make_arm(2, 3);
  for (const rbf::Kernel kernel : {rbf::Kernel::cubic, rbf::Kernel::linear, rbf::Kernel::gaussian,
                                   rbf::Kernel::bspline, rbf::Kernel::wendland}) {
    const Refined result = refined(start_of(arm, kernel), arm.measure(), with_points(60));
    EXPECT_LT(10 * result.rounds.back().after.largest, result.before.largest)
        << rbf::kernel_name(kernel);
  }
}

TEST(Refine, InsertedPointsHaveTheParametersAskedFor) {
  const test::Arm arm = test::make_arm(2, 3);
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
  const test::Arm arm = test::make_arm(3, 3);
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
  const test::Arm arm = test::make_arm(2, 3);
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
  const test::Arm arm = test::make_arm(2, 3);
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

// f(w) = sum w_i p_i, to which `more` is added.
rbf::Measure straight(int dimensions, const Values& parameters,
                      std::function<double(std::span<const double>)> more = {}) {
  return [=](std::span<const double> weights, std::span<double> out,
             std::span<double> jacobian) -> Status {
    const auto d = static_cast<std::size_t>(dimensions);
    const auto value = [&](std::span<const double> w, std::size_t a) {
      double sum = more ? more(w) : 0;
      for (std::size_t j = 0; j < w.size(); ++j) sum += w[j] * parameters[j * d + a];
      return sum;
    };
    for (std::size_t a = 0; a < d; ++a) out[a] = value(weights, a);
    if (jacobian.empty()) return {};
    Values moved(weights.begin(), weights.end());
    for (std::size_t a = 0; a < d; ++a) {
      for (std::size_t j = 0; j < moved.size(); ++j) {
        moved[j] = weights[j] + 1e-6;
        const double above = value(moved, a);
        moved[j] = weights[j] - 1e-6;
        jacobian[a * moved.size() + j] = (above - value(moved, a)) / 2e-6;
        moved[j] = weights[j];
      }
    }
    return {};
  };
}

const Values kSquare = {0, 0, 1, 0, 0, 1, 1, 1, 0.5, 0.5};

TEST(Refine, LeavesWhatIsExactAlone) {
  const Refined result = refined(start_of(2, kSquare), straight(2, kSquare), {});
  EXPECT_EQ(result.stop, Stop::exact);
  EXPECT_TRUE(result.rounds.empty());
  EXPECT_EQ(result.function, start_of(2, kSquare).function);
  EXPECT_LT(result.before.largest, 1e-12);
}

TEST(Refine, KeepsTheWeightsOfRowsWithinTheLimits) {
  const test::Arm arm = test::make_arm(2, 3);
  RefineOptions options = with_points(40);
  options.least = -0.06;
  options.largest = 1;
  const Refined result = refined(start_of(arm), arm.measure(), options);
  EXPECT_EQ(result.function.inserted(), 40);
  for (const double weight : result.function.inserted_rows) {
    EXPECT_GE(weight, -0.06);
    EXPECT_LE(weight, 1);
  }
  // The worst places want more than this.
  options.least = -0.02;
  const Refined none = refined(start_of(arm), arm.measure(), options);
  EXPECT_EQ(none.stop, Stop::stalled);
  EXPECT_EQ(none.function, start_of(arm).function);
  int by_weights = 0;
  for (const RefusedPoint& refused : none.refused) {
    if (refused.reason != Refusal::weights) continue;
    ++by_weights;
    EXPECT_LT(refused.value, -0.02);
  }
  EXPECT_GT(by_weights, 3);
}

TEST(Refine, RefusesWhatNoWeightsGive) {
  // Nothing gets higher than 0.7, whatever the weights.
  const Refined start = start_of(1, {0, 0.3, 0.7, 1});
  const rbf::Measure capped = [](std::span<const double> w, std::span<double> out,
                                 std::span<double> jacobian) -> Status {
    const double sum = 0.3 * w[1] + 0.7 * w[2] + w[3];
    out[0] = std::min(sum, 0.7);
    const double slope = sum < 0.7 ? 1 : 0;
    if (!jacobian.empty()) {
      jacobian[0] = 0, jacobian[1] = 0.3 * slope, jacobian[2] = 0.7 * slope, jacobian[3] = slope;
    }
    return {};
  };
  const Refined result = refined(start, capped, {});
  EXPECT_EQ(result.stop, Stop::stalled);
  EXPECT_EQ(result.function.inserted(), 0);
  int residuals = 0;
  for (const RefusedPoint& refused : result.refused) {
    EXPECT_GT(refused.point[0], 0.7);
    if (refused.reason == Refusal::near) continue;  // the last example
    ++residuals;
    EXPECT_EQ(refused.reason, Refusal::residual);
    EXPECT_NEAR(refused.value, refused.point[0] - 0.7, 1e-9);
  }
  EXPECT_GT(residuals, 0);
  EXPECT_NEAR(result.example_error, 0.3, 1e-12);  // the last example is none
}

TEST(Refine, TakesBackWhatMakesOtherPlacesWorse) {
  // Ripples much finer than the points can follow.
  const rbf::Measure rippled = straight(2, kSquare, [](std::span<const double> w) {
    return 0.02 * std::sin(300 * w[0]) * w[0] * (1 - w[0]);
  });
  const Refined result = refined(start_of(2, kSquare), rippled, with_points(60));
  EXPECT_THAT(result.refused,
              testing::Contains(testing::Field(&RefusedPoint::reason, Refusal::growth)));
  double least = result.before.mean_square;
  for (const RefineRound& round : result.rounds) {
    EXPECT_LE(round.after.mean_square, 1.25 * least + 1e-18);
    least = std::min(least, round.after.mean_square);
  }
}

TEST(Refine, RefusesPointsNextToCentres) {
  // All of the error stands at 0.02 from the middle example.
  const rbf::Measure spiked = straight(2, kSquare, [](std::span<const double> w) {
    return 0.3 * (1 - w[4]) * std::exp(-std::pow((1 - w[4]) / 0.05, 2));
  });
  RefineOptions options = with_points(20);
  options.sweep = 4096;
  const Refined result = refined(start_of(2, kSquare), spiked, options);
  EXPECT_THAT(result.refused,
              testing::Contains(testing::Field(&RefusedPoint::reason, Refusal::near)));
  for (const RefusedPoint& refused : result.refused) {
    if (refused.reason != Refusal::near) continue;
    EXPECT_LT(std::hypot(refused.point[0] - 0.5, refused.point[1] - 0.5), 0.2);
  }
}

TEST(Refine, FindsOtherWeightsWhereNoPointHasWhatIsWanted) {
  // The blend along the line dips below 0 in between, and weights of the third example alone raise
  // it: no point of the line has what is wanted around 0.25.
  const Values line = {0, 0.5, 1};
  const rbf::Measure dipped = [](std::span<const double> w, std::span<double> out,
                                 std::span<double> jacobian) -> Status {
    const double fold = 4 * w[0] * w[1];
    out[0] = 0.5 * w[1] + w[2] - fold * fold;
    if (!jacobian.empty()) {
      jacobian[0] = -2 * fold * 4 * w[1];
      jacobian[1] = 0.5 - 2 * fold * 4 * w[0];
      jacobian[2] = 1;
    }
    return {};
  };
  const Refined result = refined(start_of(1, line), dipped, with_points(6));
  int by_point = 0;
  for (const RefineRound& round : result.rounds) by_point += round.by_point;
  EXPECT_LT(by_point, result.function.inserted());
  EXPECT_LT(4 * result.rounds.back().after.mean_square, result.before.mean_square);
}

TEST(Refine, GoesOnWhereSomePointsHaveNoMotion) {
  const test::Arm arm = test::make_arm(2, 3);
  const rbf::Measure partial = [&arm](std::span<const double> w, std::span<double> out,
                                      std::span<double> jacobian) -> Status {
    if (w[8] > 0.6 && w[8] < 0.9) return Error("blend-interval", "too short");
    return arm.measure()(w, out, jacobian);
  };
  const Refined result = refined(start_of(arm), partial, with_points(20));
  EXPECT_GT(result.before.failed, 0);
  EXPECT_EQ(result.function.inserted(), 20);
  EXPECT_LE(result.rounds.back().after.failed, result.before.failed);
  EXPECT_LT(4 * result.rounds.back().after.largest, result.before.largest);
}

TEST(Refine, SaysWhatIsWrong) {
  const Refined start = start_of(2, kSquare);
  const auto code = [](const Refined& from, const rbf::Measure& measure,
                       const RefineOptions& options = {}) {
    Progress quiet;
    const auto result = refine(from, measure, options, quiet);
    return result.ok() ? std::string("ok") : result.error().code + ": " + result.error().message;
  };
  using testing::HasSubstr;
  using testing::StartsWith;
  EXPECT_THAT(code(Refined{}, straight(2, kSquare)), StartsWith("rbf-dimensions"));
  const rbf::Measure last_fails = [](std::span<const double> w, std::span<double> out,
                                     std::span<double>) -> Status {
    if (w[4] > 0.999) return Error("blend-interval", "the step is too short");
    std::ranges::fill(out, 0.0);
    return {};
  };
  EXPECT_THAT(code(start, last_fails),
              testing::AllOf(StartsWith("fit-measure"), HasSubstr("example 5"),
                             HasSubstr("the step is too short")));
  const rbf::Measure inside_fails = [](std::span<const double> w, std::span<double> out,
                                       std::span<double>) -> Status {
    std::ranges::fill(
        out, *std::ranges::max_element(w) > 0.95 ? 0.0 : std::numeric_limits<double>::quiet_NaN());
    return {};
  };
  EXPECT_THAT(code(start, inside_fails),
              testing::AllOf(StartsWith("fit-measure"), HasSubstr("points within")));
  for (const auto change : std::initializer_list<void (*)(RefineOptions&)>{
           [](RefineOptions& o) { o.points = -1; }, [](RefineOptions& o) { o.tolerance = {1}; },
           [](RefineOptions& o) {
             o.tolerance = {1, -1};
           },
           [](RefineOptions& o) {
             o.tolerance = {1, std::nan("")};
           },
           [](RefineOptions& o) { o.points_a_round = 0; }, [](RefineOptions& o) { o.scale = 0; },
           [](RefineOptions& o) { o.least = 0.1; },
           [](RefineOptions& o) { o.largest = std::nan(""); }}) {
    RefineOptions options;
    change(options);
    EXPECT_THAT(code(start, straight(2, kSquare), options), StartsWith("fit-options"));
  }
}

TEST(Refine, LooksInsideOnly) {
  const test::Arm arm = test::make_arm(2, 3);
  RefineOptions options = with_points(20);
  options.inside = [](std::span<const double> point) { return point[0] + point[1] < 1.2; };
  const Refined result = refined(start_of(arm), arm.measure(), options);
  EXPECT_EQ(result.function.inserted(), 20);
  for (int k = 9; k < result.function.centre_count(); ++k) {
    EXPECT_TRUE(options.inside(result.function.centre(k)));
  }
  EXPECT_LT(error_at(result, 20), 0.002);
  options.inside = [](auto) { return false; };
  Progress quiet;
  const auto nowhere = refine(start_of(arm), arm.measure(), options, quiet);
  ASSERT_FALSE(nowhere.ok());
  EXPECT_EQ(nowhere.error().code, "fit-inside");
}

TEST(Refine, TellsHowFarItIs) {
  struct Counter : Progress {
    std::uint64_t total = 0, steps = 0;
    int ends = 0;
    void begin(std::string_view, std::uint64_t all) override { total = all; }
    void advance(std::uint64_t more) override { steps += more; }
    void end() override { ++ends; }
  } counter;
  const test::Arm arm = test::make_arm(2, 3);
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
