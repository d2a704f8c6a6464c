// If these fail, what a library says of how well it fills gaps is wrong.

#include "parametric/leave_one_out.h"

#include <gmock/gmock.h>

#include "rbf/weight_solver.h"
#include "walks.h"

namespace krok::parametric {
namespace {

const Library& length_and_height_library() {
  static const Library made =
      test::library_of(test::grid_walks(false), {"step.length", "step.height"}, {.mirror = false})
          .library;
  return made;
}

double mean(const std::vector<HeldOut>& all, double HeldOut::*value) {
  double sum = 0;
  int count = 0;
  for (const HeldOut& one : all) {
    if (one.failed || !one.inside) continue;
    sum += one.*value;
    ++count;
  }
  EXPECT_GT(count, 0);
  return sum / count;
}

TEST(LeaveOneOut, WeightsFillGapsBetterThanPlanesAndNeighbours) {
  const auto held = leave_one_out(length_and_height_library(), rbf::Kernel::cubic);
  ASSERT_TRUE(held.ok()) << held.error().message;
  ASSERT_EQ(held->size(), 9u);
  std::printf("inside, mean distance of joints: weights %.1f mm, planes %.1f mm, nearest %.1f mm\n",
              1000 * mean(*held, &HeldOut::weighted), 1000 * mean(*held, &HeldOut::linear),
              1000 * mean(*held, &HeldOut::nearest));
  EXPECT_LT(mean(*held, &HeldOut::weighted), mean(*held, &HeldOut::linear));
  EXPECT_LT(mean(*held, &HeldOut::weighted), mean(*held, &HeldOut::nearest));
  // The middle of the grid lies inside, a corner does not.
  EXPECT_TRUE((*held)[4].inside);
  EXPECT_FALSE((*held)[0].inside);
  EXPECT_GT((*held)[4].nearest, 0.01);
}

// With the same example twice as another's neighbour nothing is missing.
TEST(LeaveOneOut, AnExampleThatIsTwiceThereIsItsNearestNeighbour) {
  Library twice = length_and_height_library();
  Example image = twice.examples[4];
  image.parameters[0] += 5e-3;
  twice.examples.push_back(image);
  const auto held = leave_one_out(twice, rbf::Kernel::cubic);
  ASSERT_TRUE(held.ok()) << held.error().message;
  EXPECT_NEAR(held->back().nearest, 0, 1e-6);
  EXPECT_LT(held->back().weighted, 5e-3);
}

TEST(LeaveOneOut, SaysWhenThereIsTooLittle) {
  Library few = length_and_height_library();
  few.examples.resize(2);
  EXPECT_EQ(leave_one_out(few, rbf::Kernel::cubic).error().code, "rbf-examples");
  // Without one of three there are too few for two parameters.
  few.examples = {length_and_height_library().examples[0], length_and_height_library().examples[1],
                  length_and_height_library().examples[3]};
  const auto held = leave_one_out(few, rbf::Kernel::cubic);
  ASSERT_TRUE(held.ok()) << held.error().message;
  for (const HeldOut& one : *held) EXPECT_TRUE(one.failed);
}

// Each step twice, once leaning 5 cm to the left and once to the right, and measured a little off:
// what weights that meet all would follow.
Library contradicting() {
  Library result = length_and_height_library();
  result.examples.clear();
  for (const Example& example : length_and_height_library().examples) {
    for (const double sign : {-1.0, 1.0}) {
      Example& leaning = result.examples.emplace_back(example);
      const auto& names = leaning.motion.skeleton.names;
      for (std::size_t i = 0; i < leaning.motion.positions.size(); ++i) {
        const std::string& name = names[i % names.size()];
        const bool leg = name == "Hips" || name.ends_with("Leg") || name.ends_with("Foot") ||
                         name.find("Toe") != std::string::npos;
        if (!leg) leaning.motion.positions[i].x() += static_cast<float>(sign * 0.05);
      }
      leaning.parameters[0] += sign * 0.005;
      leaning.parameters[1] -= sign * 0.004;
    }
  }
  return result;
}

TEST(LeaveOneOut, SmoothingMakesContradictingExamplesBetter) {
  const std::vector<double> smoothings = {0, 0.01, 0.1};
  const auto trials = try_smoothings(contradicting(), rbf::Kernel::cubic, smoothings);
  ASSERT_TRUE(trials.ok()) << trials.error().message;
  ASSERT_EQ(trials->size(), 3u);
  for (const SmoothingTrial& trial : *trials) {
    std::printf("smoothed by %g: %.1f mm\n", trial.smoothing, 1000 * trial.weighted);
  }
  EXPECT_LT((*trials)[1].weighted, 0.75 * (*trials)[0].weighted);
  // The same figures as leave_one_out() gives, with any number of threads.
  const auto held = leave_one_out(contradicting(), rbf::Kernel::cubic, 0.1, 2);
  ASSERT_TRUE(held.ok());
  EXPECT_EQ(means_of(*held).weighted, (*trials)[2].weighted);
  EXPECT_EQ(means_of(*held).examples, (*trials)[2].examples);
  EXPECT_LT(means_of(*held).weighted, means_of(*held).linear);
  EXPECT_LT(means_of(*held).weighted, means_of(*held).nearest);
  // Of examples that agree there is nothing to average.
  const auto agreed = try_smoothings(length_and_height_library(), rbf::Kernel::cubic, smoothings);
  ASSERT_TRUE(agreed.ok());
  EXPECT_LT((*agreed)[0].weighted, (*agreed)[2].weighted);
}

TEST(LeaveOneOut, TellsHowFarOffExamplesComeBack) {
  const Library all = contradicting();
  std::vector<double> parameters;
  for (const Example& example : all.examples) {
    parameters.insert(parameters.end(), example.parameters.begin(), example.parameters.end());
  }
  for (const double smoothing : {0.0, 0.1}) {
    const auto solver =
        rbf::WeightSolver::create(2, parameters, {rbf::Kernel::cubic, {}, {}, smoothing});
    ASSERT_TRUE(solver.ok());
    const auto distances = distances_to_examples(all, solver->function());
    ASSERT_TRUE(distances.ok()) << distances.error().message;
    ASSERT_EQ(distances->size(), all.examples.size());
    for (const double distance : *distances) {
      if (smoothing == 0) {
        EXPECT_LT(distance, 1e-5);
      } else {
        EXPECT_GT(distance, 1e-3);
        EXPECT_LT(distance, 0.2);
      }
    }
    EXPECT_EQ(distances_to_examples(length_and_height_library(), solver->function()).error().code,
              "parametric-weights");
  }
}

}  // namespace
}  // namespace krok::parametric
