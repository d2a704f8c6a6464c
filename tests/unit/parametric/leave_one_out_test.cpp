// If these fail, what a library says of how well it fills gaps is wrong.

#include "parametric/leave_one_out.h"

#include <gmock/gmock.h>

#include <numeric>

#include "parametric/try_weights.h"
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
  const auto held = [](const Library& library, double smoothing, int jobs) {
    return means_of(*leave_one_out(library, rbf::Kernel::cubic, smoothing, jobs));
  };
  const LeftOutMeans met = held(contradicting(), 0, 1), smoothed = held(contradicting(), 0.1, 1);
  std::printf("met: %.1f mm, smoothed: %.1f mm\n", 1000 * met.weighted, 1000 * smoothed.weighted);
  EXPECT_LT(smoothed.weighted, 0.75 * met.weighted);
  EXPECT_LT(smoothed.weighted, smoothed.linear);
  EXPECT_LT(smoothed.weighted, smoothed.nearest);
  // With any number of threads.
  EXPECT_EQ(held(contradicting(), 0.1, 2).weighted, smoothed.weighted);
  // Of examples that agree there is nothing to average.
  const Library& agreed = length_and_height_library();
  EXPECT_LT(held(agreed, 0, 1).weighted, held(agreed, 0.1, 1).weighted);
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

// The captures of the grid, a step of each.
std::vector<int> each_alone(const Library& library) {
  std::vector<int> groups(library.examples.size());
  std::iota(groups.begin(), groups.end(), 0);
  return groups;
}

const WeightCandidate kTried[] = {{rbf::Kernel::cubic, 0, 0},
                                  {rbf::Kernel::linear, 0, 0},
                                  {rbf::Kernel::cubic, 0.1, 0},
                                  {rbf::Kernel::cubic, 100, 0}};

// One clip left out at a time is leaving one out.
TEST(TryWeights, AgreesWithLeavingOneOut) {
  const Library& library = length_and_height_library();
  const auto trials = try_weights(library, each_alone(library), kTried);
  ASSERT_TRUE(trials.ok()) << trials.error().message;
  const LeftOutMeans one = means_of(*leave_one_out(library, rbf::Kernel::cubic));
  EXPECT_EQ(trials->examples, one.examples);
  EXPECT_EQ(trials->groups, one.examples);
  EXPECT_NEAR(trials->tried[0].distance, one.weighted, 1e-9);
  EXPECT_NEAR(trials->planes, one.linear, 1e-9);
  EXPECT_NEAR(trials->nearest, one.nearest, 1e-9);
  // Much smoothing is an affine fit.
  EXPECT_NEAR(trials->tried[3].distance, trials->planes, 0.02 * trials->planes);
  for (const WeightTrial& trial : trials->tried) EXPECT_EQ(trial.failed, 0);
  const auto parallel = try_weights(library, each_alone(library), kTried, 2);
  for (std::size_t c = 0; c < std::size(kTried); ++c) {
    EXPECT_EQ(parallel->tried[c].distance, trials->tried[c].distance);
  }
}

// Where examples agree, weights that meet them are best, and where they contradict each other,
// those that average them: a choice by these figures is right in both.
TEST(TryWeights, TellsContradictionFromAgreement) {
  const Library& agree = length_and_height_library();
  const auto clean = try_weights(agree, each_alone(agree), kTried);
  ASSERT_TRUE(clean.ok());
  EXPECT_LT(clean->tried[0].distance, clean->tried[2].distance);
  EXPECT_LT(clean->tried[0].distance, clean->planes);
  const Library noisy = contradicting();
  const auto told = try_weights(noisy, each_alone(noisy), kTried);
  ASSERT_TRUE(told.ok()) << told.error().message;
  EXPECT_GT(told->tried[0].distance, 1.2 * told->tried[2].distance);
}

WeightTrials trials_of(std::initializer_list<WeightTrial> tried, std::size_t best) {
  WeightTrials trials;
  trials.tried = tried;
  trials.best = best;
  return trials;
}

// If it fails, libraries of few captures follow their noise, or smooth examples that agree.
TEST(TryWeights, UsesTheMostSmoothingThatIsNotClearlyWorse) {
  const WeightTrial exact = {{rbf::Kernel::cubic, 0, 0}, 0.120, 0, 0.01};
  const WeightTrial little = {{rbf::Kernel::cubic, 0.1, 0}, 0.100, 0, 0};
  const WeightTrial more = {{rbf::Kernel::cubic, 1, 0}, 0.101, 0, 0.002};
  const WeightTrial most = {{rbf::Kernel::cubic, 10, 0}, 0.110, 0, 0.003};
  EXPECT_EQ(trial_to_use(trials_of({exact, little, more, most}, 1), 1.03), 2u);
  // The first is good enough.
  EXPECT_EQ(trial_to_use(trials_of({exact, little, more, most}, 1), 1.2), 0u);
  // One that makes no motion for some example is not used.
  WeightTrial broken = more;
  broken.failed = 1;
  EXPECT_EQ(trial_to_use(trials_of({exact, little, broken, most}, 1), 1.03), 1u);
  // A best one that reproduces examples stays, whatever is near it.
  const WeightTrial linear = {{rbf::Kernel::linear, 0, 0}, 0.099, 0, 0};
  EXPECT_EQ(trial_to_use(trials_of({exact, linear, little, more}, 1), 1.03), 1u);
}

// If it fails, steps of one capture count as independent of each other: twice as many of them would
// seem to tell more.
TEST(TryWeights, UncertaintyIsThatOfCaptures) {
  const Library noisy = contradicting();
  std::vector<int> groups;
  for (std::size_t i = 0; i < noisy.examples.size(); ++i) groups.push_back(static_cast<int>(i / 2));
  const auto once = try_weights(noisy, groups, kTried);
  ASSERT_TRUE(once.ok()) << once.error().message;
  Library twice = noisy;
  for (const Example& example : noisy.examples) {
    twice.examples.push_back(example);
    twice.examples.back().parameters[0] += 1e-5;
  }
  std::vector<int> both = groups;
  both.insert(both.end(), groups.begin(), groups.end());
  const auto again = try_weights(twice, both, kTried);
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(once->tried[once->best].uncertain, 0);
  for (const WeightTrial& trial : once->tried) {
    EXPECT_GE(trial.distance, once->tried[once->best].distance);
  }
  const double error = once->tried[3].uncertain;
  EXPECT_GT(error, 0);
  EXPECT_NEAR(again->tried[3].uncertain, error, 0.35 * error);
}

// The other steps of a capture tell too much of the one left out.
TEST(TryWeights, LeavesOutWholeCaptures) {
  Library twice = length_and_height_library();
  std::vector<int> groups = each_alone(twice);
  const std::size_t count = twice.examples.size();
  for (std::size_t i = 0; i < count; ++i) {
    twice.examples.push_back(twice.examples[i]);
    twice.examples.back().parameters[0] += 2e-3;
    groups.push_back(groups[i]);
  }
  const auto apart = try_weights(twice, each_alone(twice), kTried);
  const auto together = try_weights(twice, groups, kTried);
  ASSERT_TRUE(apart.ok() && together.ok());
  EXPECT_LT(apart->nearest, 1e-3);
  EXPECT_GT(together->nearest, 0.01);
  groups.pop_back();
  EXPECT_EQ(try_weights(twice, groups, kTried).error().code, "parametric-groups");
}

}  // namespace
}  // namespace krok::parametric
