// If these fail, a library that is asked for a step gives another one and does not say so.

#include "parametric/synthesise.h"

#include <gmock/gmock.h>

#include "rbf/weight_solver.h"
#include "walks.h"

namespace krok::parametric {
namespace {

using testing::HasSubstr;

struct Fitted {
  Library library;
  rbf::WeightFunction weights;
};

rbf::WeightFunction weights_of(const Library& library) {
  std::vector<double> parameters;
  for (const Example& example : library.examples) {
    parameters.insert(parameters.end(), example.parameters.begin(), example.parameters.end());
  }
  const auto solver = rbf::WeightSolver::create(library.dimensions(), parameters);
  EXPECT_TRUE(solver.ok()) << solver.error().message;
  return solver.ok() ? solver->function() : rbf::WeightFunction();
}

const Fitted& fitted(bool turns) {
  static const auto make = [](bool three) {
    std::vector<std::string> parameters = {"step.length", "step.height"};
    if (three) parameters.push_back("step.turn");
    Fitted made;
    made.library =
        test::library_of(test::grid_walks(three), parameters, {.mirror = false, .outlier = 0})
            .library;
    made.weights = weights_of(made.library);
    return made;
  };
  static const Fitted two = make(false), three = make(true);
  return turns ? three : two;
}

Synthesiser synthesiser(bool turns) {
  auto made = Synthesiser::create(fitted(turns).library, fitted(turns).weights);
  EXPECT_TRUE(made.ok()) << made.error().message;
  return *std::move(made);
}

TEST(Synthesise, AtAnExampleItIsTheExample) {
  for (const bool turns : {false, true}) {
    const Synthesiser made = synthesiser(turns);
    const auto& examples = fitted(turns).library.examples;
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const auto found = made.weights(examples[i].parameters);
      ASSERT_TRUE(found.ok()) << found.error().message;
      for (std::size_t j = 0; j < examples.size(); ++j) {
        EXPECT_NEAR(found->weights[j], i == j ? 1 : 0, 1e-9);
      }
      EXPECT_LT(found->error, 0.01);
    }
  }
}

// Half-way between the examples' parameters.
std::vector<std::vector<double>> grid(const Bounds& bounds, int count) {
  const auto d = bounds.lower.size();
  std::vector<std::vector<double>> points = {{}};
  for (std::size_t k = 0; k < d; ++k) {
    std::vector<std::vector<double>> more;
    for (const auto& point : points) {
      for (int i = 0; i < count; ++i) {
        more.push_back(point);
        more.back().push_back(bounds.lower[k] +
                              (i + 0.5) / count * (bounds.upper[k] - bounds.lower[k]));
      }
    }
    points = std::move(more);
  }
  return points;
}

TEST(Synthesise, CorrectionBringsTheMotionToWhatWasAsked) {
  for (const bool turns : {false, true}) {
    const Synthesiser made = synthesiser(turns);
    double before = 0, after = 0, least = 0;
    int asked = 0;
    for (const auto& point : grid(made.bounds(), turns ? 7 : 15)) {
      if (outside(made.bounds(), point).distance > 0) continue;
      ++asked;
      const auto found = made.weights(point, {.corrections = 2});
      ASSERT_TRUE(found.ok()) << found.error().message;
      before = std::max(before, found->error_before);
      after = std::max(after, found->error);
      double sum = 0;
      for (const double weight : found->weights) {
        sum += weight;
        least = std::min(least, weight);
      }
      EXPECT_NEAR(sum, 1, 1e-12);
      // What is said to be measured is what the motion does.
      const auto motion = made.motion(found->weights);
      ASSERT_TRUE(motion.ok());
      EXPECT_GT(motion->duration(), 0.3);
    }
    std::printf(
        "%d parameters, %d points: largest error %.2f tolerances, corrected %.5f; "
        "least weight %.3f\n",
        made.bounds().dimensions, asked, before, after, least);
    EXPECT_GT(asked, turns ? 200 : 150);
    EXPECT_GT(before, turns ? 1 : 0.1);
    EXPECT_LT(after, 0.02);
  }
}

// Two examples as good as equal but for a centimetre of height: what lies between the others there
// needs them many times over, against each other.
TEST(Synthesise, WeightsThatAreNoBlendAreRefused) {
  Fitted crowded = fitted(false);
  Library& library = crowded.library;
  Example near = library.examples[4];
  near.parameters[1] += 0.01;
  near.parameters[0] += 0.002;
  library.examples.push_back(near);
  crowded.weights = weights_of(library);
  const auto made = Synthesiser::create(library, crowded.weights);
  ASSERT_TRUE(made.ok());
  int refused = 0;
  for (const auto& point : grid(made->bounds(), 15)) {
    if (outside(made->bounds(), point).distance > 0) continue;
    const auto plain = made->weights(point);
    const auto beyond = made->weights(point, {.extrapolate = true});
    ASSERT_TRUE(beyond.ok());
    const auto [least, most] = std::ranges::minmax(beyond->weights);
    const bool is_blend = least >= kMinWeight && most <= kMaxWeight;
    EXPECT_EQ(plain.ok(), is_blend) << least << " " << most;
    if (plain) continue;
    ++refused;
    EXPECT_EQ(plain.error().code, "parametric-extrapolation");
    EXPECT_THAT(plain.error().message, HasSubstr("weight"));
  }
  EXPECT_GT(refused, 10);
}

TEST(Synthesise, OutsideTheExamplesItSaysWhereTheyEnd) {
  const Synthesiser made = synthesiser(false);
  const std::vector<double> far = {1.4, 0};
  const auto found = made.weights(far);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, "parametric-bounds");
  EXPECT_THAT(found.error().message, HasSubstr("step.length 1.4 m"));
  EXPECT_THAT(found.error().hint, HasSubstr("the nearest parameters inside are step.length 0.7"));
  EXPECT_TRUE(made.weights(outside(made.bounds(), far).nearest).ok());
  const auto beyond = made.weights(std::vector{0.85, 0.0}, {.extrapolate = true});
  ASSERT_TRUE(beyond.ok());
  EXPECT_GT(beyond->parameters[0], 0.78);
  EXPECT_EQ(made.weights(std::vector{std::nan(""), 0.0}, {.extrapolate = true}).error().code,
            "parametric-bounds");
  EXPECT_EQ(made.weights(std::vector{0.6}).error().code, "parametric-bounds");
}

// Would fail if the parameters that the message names, rounded as it prints them, were refused
// again.
TEST(Synthesise, TheNearestParametersInsideAreInside) {
  const Synthesiser made = synthesiser(false);
  int tried = 0;
  for (int i = 0; i < 40; ++i) {
    const std::vector<double> far = {0.6 + std::cos(i), 2 * std::sin(i)};
    const auto refused = made.weights(far);
    if (refused.ok() || refused.error().code != "parametric-bounds") continue;
    double length = 0, degrees = 0;
    ASSERT_EQ(std::sscanf(refused.error().hint.c_str(),
                          "the nearest parameters inside are step.length %lf m, %*s %lf", &length,
                          &degrees),
              2)
        << refused.error().hint;
    const std::vector<double> named = {length, degrees * kRadiansPerDegree};
    EXPECT_EQ(outside(made.bounds(), named).distance, 0) << refused.error().hint;
    ++tried;
  }
  EXPECT_GT(tried, 20);
}

TEST(Synthesise, RefusesWeightsOfAnotherLibrary) {
  const auto made = Synthesiser::create(fitted(true).library, fitted(false).weights);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, "parametric-weights");
  rbf::WeightFunction odd = fitted(false).weights;
  odd.affine.pop_back();
  EXPECT_EQ(Synthesiser::create(fitted(false).library, odd).error().code, "rbf-shape");
  Library broken = fitted(false).library;
  broken.examples[0].parameters[0] = std::nan("");
  EXPECT_EQ(Synthesiser::create(broken, fitted(false).weights).error().code, "parametric-example");
}

}  // namespace
}  // namespace krok::parametric
