// The style of real steps on top of smoothed weights, and sums of examples. If these fail, walks
// from many captures look like nobody, mix what several people do, are not the same again, or long
// walks differ from what the weights say.

#include <gmock/gmock.h>

#include <set>
#include <string>
#include <vector>

#include "core/index.h"
#include "gait/body_motion_internal.h"
#include "math/quaternion.h"
#include "parametric/example_sums.h"
#include "parametric/style_groups.h"
#include "unit/gait/walkers.h"

namespace krok::gait {
namespace {

constexpr double kHunched = 0.5, kToesOut = 0.2;  // radians

// A joint and all below it turned about the joint, in every frame.
void turn_with_all_below(Clip& clip, Role role, Axis axis, double angle) {
  const int top = find_roles(clip.skeleton).joint(role);
  ASSERT_GE(top, 0);
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    const Quat turn = axis_rotation(axis, angle);
    const Vec3 about = pose[at(top)].position;
    for (int j = 0; j < clip.joint_count(); ++j) {
      if (j != top && !is_below(clip.skeleton, j, top)) continue;
      pose[at(j)].position = about + turn * (pose[at(j)].position - about);
      pose[at(j)].orientation = turn * pose[at(j)].orientation;
    }
    clip.set_pose(f, pose);
  }
}

// The chest and all above it turned forward, toes outwards.
void hunch(Clip& clip) {
  turn_with_all_below(clip, Role::chest, Axis::x, kHunched);
  turn_with_all_below(clip, Role::left_foot, Axis::y, kToesOut);
  turn_with_all_below(clip, Role::right_foot, Axis::y, -kToesOut);
}

// Ten noisy walks, every second one hunched; their steps, which contradict each other, smoothed.
StepLibrary noisy_library(double smoothing = 10) {
  std::vector<parametric::test::KeyedWalk> walks;
  for (int i = 0; i < 10; ++i) {
    samples::WalkOptions options;
    options.steps = 8;
    options.step_length = 0.5 + 0.03 * i;
    options.noise_angle = 0.002;
    options.seed = static_cast<std::uint64_t>(i) + 1;
    walks.push_back(parametric::test::keyed_walk(options));
    if (i % 2 == 1) hunch(walks.back().walk.clip);
  }
  auto library =
      parametric::test::library_of(walks, {"step.length"}, {.mirror = true, .outlier = 0}).library;
  std::vector<double> parameters;
  for (auto& example : library.examples) {
    const bool is_hunched = (example.name[4] - '0') % 2 == 1;  // "walk3 2 left"
    example.name = (is_hunched ? "Hunched " : "upright ") + example.name;
    parameters.insert(parameters.end(), example.parameters.begin(), example.parameters.end());
  }
  rbf::SolverOptions options;
  options.smoothing = smoothing;
  const auto solver = rbf::WeightSolver::create(1, parameters, options);
  EXPECT_TRUE(solver.ok());
  const RoleMap roles = find_roles(library.skeleton);
  auto made = StepLibrary::create("noisy", std::move(library), solver->function(), roles);
  EXPECT_TRUE(made.ok()) << made.error().message;
  return *std::move(made);
}

// In one style, or in all.
std::vector<StepLibrary> noisy_in(const std::string& style) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(noisy_library());
  EXPECT_TRUE(take_style(libraries, style).ok());
  return libraries;
}

std::span<const StepLibrary> noisy() {
  static const std::vector<StepLibrary> kLibraries = [] {
    std::vector<StepLibrary> libraries;
    libraries.push_back(noisy_library());
    return libraries;
  }();
  return kLibraries;
}

WalkOptions seeded(std::uint64_t seed) {
  WalkOptions options;
  options.seed = seed;
  return options;
}

WholeWalk walked(const WalkOptions& options, int steps = 8,
                 std::span<const StepLibrary> libraries = noisy()) {
  auto made =
      walk(libraries, test::prints_of({.steps = steps, .length = 0.62}), test::slope(0), options);
  EXPECT_TRUE(made.ok()) << made.error().message;
  return *std::move(made);
}

// Radians by which the chest leans forward, mean over the middle of the walk.
double lean(const Clip& clip) {
  const int chest = find_roles(clip.skeleton).joint(Role::chest);
  double sum = 0;
  int count = 0;
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = clip.frame_count() / 3; f < 2 * clip.frame_count() / 3; ++f, ++count) {
    clip.get_pose(f, pose);
    const Vec3 up = pose[at(chest)].orientation * Vec3::UnitY();
    sum += std::atan2(up.z(), up.y());
  }
  return sum / count;
}

// Would fail if a step were still the average of all captures, or took the style of others.
TEST(StepStyle, IsThatOfTheNamedCaptures) {
  WalkOptions options;
  options.variation = 1;
  const std::vector<StepLibrary> bent = noisy_in("hunched"), straight = noisy_in("UPRIGHT");
  const WholeWalk hunched = walked(options, 8, bent), upright = walked(options, 8, straight);
  options.variation = 0;
  const double average = lean(walked(options).clip);
  EXPECT_NEAR(lean(hunched.clip) - lean(upright.clip), kHunched, 0.1 * kHunched);
  EXPECT_NEAR(average - lean(upright.clip), 0.5 * kHunched, 0.15 * kHunched);
  const WalkDetails& details = hunched.details;
  EXPECT_FALSE(details.steps.front().example.empty());
  for (const StepReport& step : details.steps) {
    // The last one comes to stand, which no example does.
    if (step.example.empty() && &step == &details.steps.back()) continue;
    EXPECT_THAT(step.example, testing::StartsWith("Hunched ")) << step.stance;
  }
}

// Would fail if a style faded towards everybody's average with the variation.
TEST(StepStyle, IsTheAverageOfTheNamedCapturesWithoutVariation) {
  WalkOptions options;
  options.variation = 0;
  const std::vector<StepLibrary> bent = noisy_in("hunched"), straight = noisy_in("upright");
  const WholeWalk hunched = walked(options, 8, bent), upright = walked(options, 8, straight);
  EXPECT_NEAR(lean(hunched.clip) - lean(upright.clip), kHunched, 0.1 * kHunched);
  for (const StepReport& step : hunched.details.steps) {
    EXPECT_EQ(step.example, "");
    EXPECT_LT(step.missed, 1e-6);
  }
}

// Would fail if a walk changed its style from step to step.
TEST(StepStyle, IsOneForTheWholeWalk) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const WalkDetails details = walked(seeded(seed)).details;
    for (const StepReport& step : std::span(details.steps).first(details.steps.size() - 1)) {
      EXPECT_EQ(step.example.substr(0, 7), details.steps.front().example.substr(0, 7)) << seed;
    }
  }
}

TEST(StepStyle, VariesStepsAndDurationsBySeedAndIsTheSameAgain) {
  const WholeWalk first = walked(seeded(3)), again = walked(seeded(3));
  EXPECT_EQ(first.clip.positions, again.clip.positions);
  const WholeWalk other = walked(seeded(4));
  EXPECT_NE(first.clip.positions, other.clip.positions);
  // Prints are met whatever the style.
  for (const WholeWalk* one : {&first, &other}) {
    for (const StepReport& step : one->details.steps) EXPECT_LT(step.missed, 1e-6);
  }
}

// Would fail if the variation changed walks whose weights meet their examples.
TEST(StepStyle, ChangesNothingWhereWeightsMeetTheExamples) {
  const auto prints = test::prints_of({});
  const test::Ground level = test::slope(0);
  const auto with = walk(test::walking(), prints, level, {});
  WalkOptions average;
  average.variation = 0;
  const auto without = walk(test::walking(), prints, level, average);
  ASSERT_TRUE(with.ok() && without.ok());
  EXPECT_EQ(with->clip.positions, without->clip.positions);
}

TEST(StepStyle, RefusesACaptureThatTheLibraryLacks) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(noisy_library());
  const Status made = take_style(libraries, "tired");
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, "walk-style");
  EXPECT_THAT(made.error().hint, testing::HasSubstr("Hunched walk1"));
  EXPECT_FALSE(libraries.front().has_style());
}

// Would fail if a style's name were looked for among captures' names first, or its durations were
// those of others.
TEST(StepStyle, IsTheLabelledOneWithItsDurations) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(noisy_library());
  parametric::Library library =
      libraries.front().library().with(libraries.front().library().examples);
  for (auto& example : library.examples) {
    example.style = example.name.starts_with("Hunched ") ? "upright" : "old";
  }
  rbf::SolverOptions how;
  how.smoothing = 10;
  std::vector<double> parameters;
  for (const auto& example : library.examples) parameters.push_back(example.parameters.front());
  const auto solver = rbf::WeightSolver::create(1, parameters, how);
  ASSERT_TRUE(solver.ok());
  const RoleMap roles = find_roles(library.skeleton);
  auto made = StepLibrary::create("noisy", std::move(library), solver->function(), roles);
  ASSERT_TRUE(made.ok());
  ASSERT_TRUE(made->take_style("Upright"));
  const auto& examples = made->library().examples;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    EXPECT_EQ(made->in_style(i), examples[i].name.starts_with("Hunched ")) << examples[i].name;
  }
}

// Would fail if everybody's toes pointed as the average's do.
TEST(StepStyle, HasItsOwnToeOut) {
  StepLibrary library = noisy_library();
  const double usual = library.toe_out();
  ASSERT_TRUE(library.take_style("Hunched"));
  const double outwards = library.toe_out();
  ASSERT_TRUE(library.take_style("upright"));
  EXPECT_NEAR(outwards - library.toe_out(), kToesOut, 0.02);
  EXPECT_LT(library.toe_out(), usual);
  EXPECT_LT(usual, outwards);
}

// Captures of two moods, told apart by their motion alone. Would fail if groups followed the
// parameters or split captures, or if captures of one mood were divided.
TEST(StyleGroups, AreThoseOfCapturesThatMoveAlike) {
  parametric::Library library = noisy().front().library().with(noisy().front().library().examples);
  for (auto& example : library.examples) {
    if (example.name.starts_with("Hunched ")) hunch(example.motion);
  }
  const auto groups = parametric::group_styles(library, parametric::captures_of(library));
  ASSERT_TRUE(groups.ok()) << groups.error().message;
  ASSERT_EQ(groups->count, 2) << groups->spread;
  EXPECT_GT(groups->spread, parametric::kAlikeSteps);
  EXPECT_LT(groups->within, 0.02);
  std::set<std::pair<int, bool>> seen;
  std::vector<parametric::Example> upright;
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    const bool hunched = library.examples[i].name.starts_with("Hunched ");
    seen.emplace(groups->of_example[i], hunched);
    if (!hunched) upright.push_back(library.examples[i]);
  }
  EXPECT_EQ(seen.size(), 2u);
  const parametric::Library one = library.with(std::move(upright));
  const auto alike = parametric::group_styles(one, parametric::captures_of(one));
  ASSERT_TRUE(alike.ok());
  EXPECT_EQ(alike->count, 1);
  EXPECT_FALSE(parametric::group_styles(one, std::vector<int>{0}).ok());
}

// Poses of blends from sums against the blends themselves. Would fail if sums left out more than
// they say, or were in another hemisphere or time than the examples.
TEST(ExampleSums, MakeTheSamePoses) {
  const parametric::Synthesiser& steps = noisy().front().steps(FootSide::left);
  const std::size_t examples = steps.library().examples.size();
  ASSERT_GE(examples, at(parametric::ExampleSums::kMinExamples));
  std::vector<std::vector<double>> rows;
  for (int i = 0; i <= 20; ++i) {
    auto made = steps.weights(std::vector{0.5 + 0.013 * i}, {true, 3});
    ASSERT_TRUE(made.ok());
    rows.push_back(std::move(made->weights));
  }
  const std::vector<std::span<const double>> spans(rows.begin(), rows.end());
  const auto sums = parametric::ExampleSums::create(steps.packed(), spans);
  ASSERT_TRUE(sums.has_value());
  EXPECT_LE(sums->count(), 12);
  const int apart = 5;
  double position = 0, angle = 0;
  for (const double share : {0.0, 1.0}) {
    for (const auto& row : rows) {
      std::vector<double> weights = row;
      for (double& weight : weights) weight *= 1 - share;
      weights[apart] += share;
      const auto plain = steps.motion(weights);
      auto summed = steps.motion(weights);
      ASSERT_TRUE(plain.ok() && summed.ok());
      ASSERT_TRUE(summed->use(*sums, share > 0 ? apart : -1, share));
      auto scratch = plain->make_scratch();
      std::vector<PoseBlock> a(scratch.reference.size()), b(a.size());
      std::vector<Transform> pose(steps.packed().skeleton.names.size()), other(pose.size());
      for (int k = 0; k <= 50; ++k) {
        plain->pose(plain->duration() * k / 50, a, scratch);
        summed->pose(summed->duration() * k / 50, b, scratch);
        unpack_pose(a, pose);
        unpack_pose(b, other);
        for (std::size_t j = 0; j < pose.size(); ++j) {
          position = std::max(position, (pose[j].position - other[j].position).norm());
          angle = std::max(angle, angle_between(pose[j].orientation, other[j].orientation));
        }
      }
    }
  }
  // What is left out, and what interpolation differs by where examples have a corner at a frame, as
  // toes do when they strike: a quarter of a degree.
  EXPECT_LT(position, 5 * parametric::ExampleSums::kMaxLeftOut);
  EXPECT_LT(angle, 0.25 * kRadiansPerDegree);
  // A row that they do not span is not used.
  std::vector<double> one(examples, 0);
  one[apart] = 1;
  auto alone = steps.motion(one);
  ASSERT_TRUE(alone.ok());
  EXPECT_FALSE(alone->use(*sums));
}

}  // namespace
}  // namespace krok::gait
