// If these fail, a refined library gives wrong results for some parameters: weights that are not
// finite, do not sum to 1, leave their range, or jump; steps that do not have the requested
// parameters; examples that are not reproduced.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "fit/refine.h"
#include "motion/sample.h"
#include "parametric/synthesise.h"
#include "rbf/weight_solver.h"
#include "unit/parametric/walks.h"

namespace krok::parametric {
namespace {

constexpr int kPoints = 10'000;

// Five examples by length, nine by length and height, or 27 by length, height and turn, refined.
class RefinedLibrary : public testing::TestWithParam<int> {
 protected:
  static void SetUpTestSuite() {
    for (int dimensions = 1; dimensions <= 3; ++dimensions) make(dimensions);
  }
  static void TearDownTestSuite() {
    for (Made*& made : made_) {
      delete made;
      made = nullptr;
    }
  }

  struct Made {
    Library library;
    rbf::WeightFunction weights;
  };
  const Made& made() const { return *made_[GetParam() - 1]; }

  // A random point of the box of the examples' ranges, widened by the fraction `wider`.
  std::vector<double> random_point(const Bounds& bounds, double wider) {
    std::vector<double> point;
    for (std::size_t d = 0; d < bounds.lower.size(); ++d) {
      const double range = bounds.upper[d] - bounds.lower[d];
      std::uniform_real_distribution<double> within(bounds.lower[d] - wider * range,
                                                    bounds.upper[d] + wider * range);
      point.push_back(within(random_));
    }
    return point;
  }

  std::mt19937_64 random_{20'111'122};

 private:
  static std::vector<test::KeyedWalk> walks_of(int dimensions) {
    if (dimensions > 1) return test::grid_walks(dimensions == 3);
    std::vector<test::KeyedWalk> walks;
    for (const double length : {0.45, 0.55, 0.65, 0.75, 0.85}) {
      samples::WalkOptions options;
      options.steps = 2;
      options.step_length = length;
      walks.push_back(test::keyed_walk(options));
    }
    return walks;
  }

  static void make(int dimensions) {
    auto* made = new Made;
    const std::vector<std::string> all = {"step.length", "step.height", "step.turn"};
    const std::vector<std::string> names(all.begin(), all.begin() + dimensions);
    made->library =
        test::library_of(walks_of(dimensions), names, {.mirror = false, .outlier = 0}).library;
    std::vector<double> parameters;
    for (const Example& example : made->library.examples) {
      parameters.insert(parameters.end(), example.parameters.begin(), example.parameters.end());
    }
    const auto solver = rbf::WeightSolver::create(made->library.dimensions(), parameters);
    ASSERT_TRUE(solver.ok());
    const PackedExamples packed = pack_examples(made->library);
    const Measure measure(made->library, packed);
    const Bounds bounds = bounds_of(made->library);
    fit::RefineOptions options;
    options.points = dimensions == 3 ? 40 : 20;
    options.inside = [&](std::span<const double> point) {
      return outside(bounds, point).distance <= 0;
    };
    fit::Refined start;
    start.function = solver->function();
    Progress progress;
    const auto refined = fit::refine(
        start,
        [&](auto weights, auto values, auto jacobian) {
          auto scratch = measure.make_scratch();
          return measure(weights, values, jacobian, scratch);
        },
        options, progress);
    ASSERT_TRUE(refined.ok()) << refined.error().message;
    made->weights = refined->function;
    made_[dimensions - 1] = made;
  }
  static inline Made* made_[3] = {nullptr, nullptr, nullptr};
};

INSTANTIATE_TEST_SUITE_P(OneToThreeParameters, RefinedLibrary, testing::Values(1, 2, 3));

TEST_P(RefinedLibrary, GivesSoundWeightsAnywhereInside) {
  const auto synthesiser = Synthesiser::create(made().library, made().weights);
  ASSERT_TRUE(synthesiser.ok());
  int inside = 0;
  while (inside < kPoints) {
    const auto point = random_point(synthesiser->bounds(), 0);
    if (outside(synthesiser->bounds(), point).distance > 0) continue;
    ++inside;
    const auto made_of = synthesiser->weights(point);
    ASSERT_TRUE(made_of.ok()) << made_of.error().message;
    const auto& weights = made_of->weights;
    EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-12);
    for (const double weight : weights) {
      ASSERT_TRUE(weight >= -0.15 && weight < 1.25) << weight;
    }
    for (std::size_t d = 0; d < point.size(); ++d) {
      // 0.6 mm and 0.1 degrees: lengths are metres, turns radians.
      const bool turn = made().library.parameters[d].quantity == Quantity::step_turn;
      ASSERT_NEAR(made_of->parameters[d], point[d], turn ? 0.1 * kRadiansPerDegree : 0.6e-3);
    }
  }
}

// Any requested point gives an error or a finite result.
TEST_P(RefinedLibrary, PointsFarOutsideAreRefusedOrAnswered) {
  const auto synthesiser = Synthesiser::create(made().library, made().weights);
  ASSERT_TRUE(synthesiser.ok());
  int refused = 0;
  for (int k = 0; k < kPoints; ++k) {
    const auto point = random_point(synthesiser->bounds(), 1);
    const bool is_outside = outside(synthesiser->bounds(), point).distance > 0;
    const auto plain = synthesiser->weights(point);
    EXPECT_EQ(plain.ok(), !is_outside);
    refused += is_outside ? 1 : 0;
    const auto beyond = synthesiser->weights(point, {.extrapolate = true});
    if (!beyond) continue;  // rotations may cancel out there
    for (const double weight : beyond->weights) ASSERT_TRUE(std::isfinite(weight));
    for (const double value : beyond->parameters) ASSERT_TRUE(std::isfinite(value));
  }
  EXPECT_GT(refused, kPoints / 4);
  for (const double odd : {std::nan(""), double(INFINITY), 1e300}) {
    auto point = random_point(synthesiser->bounds(), 0);
    point[0] = odd;
    EXPECT_FALSE(synthesiser->weights(point).ok());
  }
}

// A step of 0.01 % of the range changes each weight by less than 20 times that.
TEST_P(RefinedLibrary, WeightsAreContinuous) {
  const auto evaluator = rbf::WeightEvaluator::create(made().weights);
  ASSERT_TRUE(evaluator.ok());
  const Bounds bounds = bounds_of(made().library);
  const std::size_t n = made().library.examples.size();
  std::vector<double> before(n), after(n);
  constexpr double kStep = 1e-4;
  for (int k = 0; k < kPoints; ++k) {
    auto point = random_point(bounds, 0);
    evaluator->weights(point, before);
    const std::size_t d = static_cast<std::size_t>(k) % point.size();
    point[d] += kStep * (bounds.upper[d] - bounds.lower[d]);
    evaluator->weights(point, after);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_LT(std::abs(after[i] - before[i]), 20 * kStep) << i;
    }
  }
}

TEST_P(RefinedLibrary, ExamplesComeBackAtTheirOwnParameters) {
  const auto synthesiser = Synthesiser::create(made().library, made().weights);
  ASSERT_TRUE(synthesiser.ok());
  for (const Example& example : made().library.examples) {
    const auto synthesis = synthesiser->weights(example.parameters);
    ASSERT_TRUE(synthesis.ok());
    const auto motion = synthesiser->motion(synthesis->weights);
    ASSERT_TRUE(motion.ok());
    const auto clip = motion->make(example.motion.rate, LastFrame::within);
    ASSERT_TRUE(clip.ok());
    const double first = example.keytimes.front();
    std::vector<Transform> made_pose(example.motion.skeleton.names.size()), pose(made_pose.size()),
        scratch(3 * pose.size());
    for (int f = 0; f < clip->clip.frame_count(); ++f) {
      clip->clip.get_pose(f, made_pose);
      sample(example.motion, first + f / example.motion.rate, pose, scratch);
      for (std::size_t j = 0; j < pose.size(); ++j) {
        ASSERT_LT((made_pose[j].position - pose[j].position).norm(), 1e-5)
            << example.name << " frame " << f << " " << example.motion.skeleton.names[j];
      }
    }
  }
}

}  // namespace
}  // namespace krok::parametric
