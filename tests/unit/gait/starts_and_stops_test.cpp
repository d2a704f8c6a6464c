// First and last steps taken from libraries of starts and stops. If these fail, an actor whose
// starts were captured starts as if they had not been, or does not come to stand where his feet
// are.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/index.h"
#include "parametric/thin_out.h"
#include "unit/gait/walkers.h"

namespace krok::gait {
namespace {

using parametric::CutOptions;
using parametric::StepGait;
using parametric::test::KeyedWalk;

KeyedWalk from_standing(double length, double turn) {
  samples::WalkOptions options;
  options.steps = 5;
  options.step_length = length;
  options.turn = turn;
  options.from_standing = true;
  return parametric::test::keyed_walk(options);
}

StepLibrary cut_from(const std::vector<KeyedWalk>& walks, StepGait gait,
                     const std::vector<std::string>& parameters, std::string name) {
  CutOptions options;
  options.gait = gait;
  options.outlier = 0;
  auto library = parametric::test::library_of(walks, parameters, options).library;
  // Steps of a walk are alike.
  std::vector<parametric::Example> kept;
  for (const int i : parametric::thin_out(library, 0.1)) kept.push_back(library.examples[at(i)]);
  library.examples = std::move(kept);
  return test::walking_library(std::move(library), std::move(name));
}

std::vector<KeyedWalk> standing_walks() {
  std::vector<KeyedWalk> walks;
  for (const double length : {0.5, 0.6, 0.7, 0.8}) walks.push_back(from_standing(length, 0));
  return walks;
}

std::vector<StepLibrary> with_starts_and_stops() {
  std::vector<StepLibrary> libraries;
  const std::vector<KeyedWalk> walks = standing_walks();
  libraries.push_back(cut_from(walks, StepGait::start, {"step.length"}, "starts"));
  libraries.push_back(cut_from(walks, StepGait::stop, {"step.length@stance_strike"}, "stops"));
  libraries.push_back(test::walking_library());
  return libraries;
}

// Would fail if starts forward and backward were blended: the body would stay between the feet's
// ways.
TEST(StartsAndStops, StartsForwardAndBackwardAreNoLibrary) {
  samples::WalkOptions options;
  options.steps = 5;
  options.from_standing = options.backward = true;
  std::vector<KeyedWalk> walks = {from_standing(0.6, 0), parametric::test::keyed_walk(options)};
  auto library =
      parametric::test::library_of(walks, {"step.length"}, {.gait = StepGait::start, .outlier = 0})
          .library;
  const RoleMap roles = find_roles(library.skeleton);
  const auto made =
      StepLibrary::create("starts", std::move(library),
                          rbf::WeightSolver::create(1, std::vector{-0.6, 0.6})->function(), roles);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, "walk-library");
  EXPECT_NE(made.error().message.find("backward in 1"), std::string::npos) << made.error().message;
}

// The footprints of a generated walk.
std::vector<Print> prints_of_capture(const samples::Walk& walk) {
  std::vector<Print> prints;
  for (const auto& print : walk.prints) {
    prints.push_back({print.side == samples::Side::left ? FootSide::left : FootSide::right,
                      print.heel.x(),
                      print.heel.z(),
                      print.heading,
                      {},
                      {}});
  }
  // The two it begins on, the foot that leaves first in front.
  if (prints.size() > 2 && prints[1].side == prints[2].side) std::swap(prints[0], prints[1]);
  return prints;
}

TEST(StartsAndStops, AreCutWhereTheActorRests) {
  const std::vector<KeyedWalk> walks = standing_walks();
  CutOptions options;
  options.gait = StepGait::start;
  options.outlier = 0;
  const auto starts = parametric::test::library_of(walks, {"step.length"}, options).library;
  EXPECT_EQ(starts.keytimes, parametric::keytimes_of(StepGait::start));
  ASSERT_EQ(starts.examples.size(), walks.size());
  for (std::size_t i = 0; i < walks.size(); ++i) {
    const auto& example = starts.examples[i];
    const auto& feet = walks[i].walk.feet;
    const double off = std::min(feet[0].offs.front(), feet[1].offs.front());
    const double strike = std::min(feet[0].strikes.front() > 0 ? feet[0].strikes.front() : 1e9,
                                   feet[1].strikes.front() > 0 ? feet[1].strikes.front() : 1e9);
    EXPECT_NEAR(example.keytimes[2] - example.keytimes[1], strike - off, 1e-6);
    EXPECT_GT(example.keytimes[1] - example.keytimes[0], 0.2) << "the weight shift belongs to it";
    const Clip& clip = example.motion;
    const auto hips = [&](int frame) { return clip.frame_positions(frame)[0]; };
    EXPECT_LT((hips(1) - hips(0)).norm() * clip.rate, 0.06) << "it begins standing";
  }
  options.gait = StepGait::stop;
  const auto stops =
      parametric::test::library_of(walks, {"step.length@stance_strike"}, options).library;
  ASSERT_EQ(stops.examples.size(), walks.size());
  for (const auto& example : stops.examples) {
    const Clip& clip = example.motion;
    const int last = clip.frame_count() - 1;
    EXPECT_LT(
        (clip.frame_positions(last)[0] - clip.frame_positions(last - 1)[0]).norm() * clip.rate,
        0.06);
    EXPECT_LT(example.parameters[0], -0.3) << "the foot comes from behind";
  }
  options.gait = StepGait::stand;
  const auto stands = parametric::test::library_of(walks, {"duration"}, options).library;
  EXPECT_GE(stands.examples.size(), walks.size());
}

// A walk on the footprints of a capture that is in no library, against that capture, before its
// first strike and around its last.
TEST(StartsAndStops, AreThoseOfTheActor) {
  const std::vector<StepLibrary> libraries = with_starts_and_stops();
  const std::span<const StepLibrary> plain(&libraries[2], 1);
  const KeyedWalk capture = from_standing(0.65, 0);
  const std::vector<Print> prints = prints_of_capture(capture.walk);
  const test::Ground level([](double, double) { return 0.0; });
  const Clip& own = capture.walk.clip;
  const auto first_strike = [](const MotionKeys& keys) {
    return std::ranges::find_if(
               keys.keytimes,
               [](const Keytime& key) { return key.name.ends_with("_strike") && key.time > 0.1; })
        ->time;
  };
  const auto last_strike = [](const MotionKeys& keys) {
    double last = 0;
    for (const Keytime& key : keys.keytimes) {
      if (key.name.ends_with("_strike")) last = std::max(last, key.time);
    }
    return last;
  };
  const auto farthest = [&](const WholeWalk& made, double here, double there, double from,
                            double to) {
    double most = 0;
    for (double t = from; t <= to; t += 0.05) {
      const int f = std::clamp(static_cast<int>(std::lround((here + t) * made.clip.rate)), 0,
                               made.clip.frame_count() - 1);
      const int g = std::clamp(static_cast<int>(std::lround((there + t) * own.rate)), 0,
                               own.frame_count() - 1);
      for (const char* name : {"Hips", "Head", "LeftHand", "LeftFoot", "RightFoot"}) {
        const int a = made.clip.skeleton.find(name), b = own.skeleton.find(name);
        if (a < 0 || b < 0) continue;
        most = std::max<double>(
            most, (made.clip.frame_positions(f)[at(a)] - own.frame_positions(g)[at(b)]).norm());
      }
    }
    return most;
  };
  const auto with = walk(libraries, prints, level, {});
  const auto without = walk(plain, prints, level, {});
  ASSERT_TRUE(with.ok()) << with.error().message;
  ASSERT_TRUE(without.ok()) << without.error().message;
  EXPECT_EQ(with->details.steps.front().library, "starts");
  EXPECT_EQ(with->details.steps[1].library, "walks");
  EXPECT_EQ(with->details.steps.back().library, "stops");
  EXPECT_TRUE(with->details.warnings.empty());
  const double there = first_strike(capture.keys);
  const double start = farthest(*with, first_strike(with->details.keys), there, -0.8, 0);
  const double plain_start =
      farthest(*without, first_strike(without->details.keys), there, -0.8, 0);
  EXPECT_LT(start, 0.06);
  EXPECT_LT(2 * start, plain_start);
  const double end = last_strike(capture.keys);
  const double stop = farthest(*with, last_strike(with->details.keys), end, -0.4, 0.4);
  const double plain_stop = farthest(*without, last_strike(without->details.keys), end, -0.4, 0.4);
  EXPECT_LT(stop, 0.05);
  EXPECT_LT(2 * stop, plain_stop);
}

// No library has width or turn as a parameter. If this fails, wide steps and turns are forced out
// of straight ones although steps like them were captured.
TEST(StepLibraries, StepsComeFromTheLibraryThatHasTheirLike) {
  const auto steady = [](double width, double turn, std::string name) {
    std::vector<KeyedWalk> walks;
    for (const double length : {0.45, 0.6, 0.75}) {
      samples::WalkOptions options;
      options.steps = 9;  // enough to tell toes that point out from a turn
      options.step_length = length;
      options.step_width = width;
      options.turn = turn;
      walks.push_back(parametric::test::keyed_walk(options));
    }
    return cut_from(walks, StepGait::walk, {"step.length"}, std::move(name));
  };
  std::vector<StepLibrary> libraries;
  libraries.push_back(steady(0.1, 0, "straight"));
  libraries.push_back(steady(0.4, 0, "wide"));
  libraries.push_back(steady(0.1, 0.5, "turning"));
  const test::Ground level([](double, double) { return 0.0; });
  const auto middle_library = [&](const test::Way& way, std::size_t step) {
    const auto made = walk(libraries, test::prints_of(way), level, {});
    EXPECT_TRUE(made.ok());
    return made.ok() ? made->details.steps[step].library : std::string();
  };
  constexpr double kToeOut = 0.1;
  EXPECT_EQ(middle_library({.width = 0.12, .toe_out = kToeOut}, 2), "straight");
  EXPECT_EQ(middle_library({.width = 0.38, .toe_out = kToeOut}, 2), "wide");
  const test::Way bend{.width = 0.12, .turn = 0.45, .toe_out = kToeOut};
  const std::string one = middle_library(bend, 2), other = middle_library(bend, 3);
  EXPECT_TRUE(one == "turning" || other == "turning") << one << ", " << other;
}

TEST(StartsAndStops, AloneAreNoWalk) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(cut_from(standing_walks(), StepGait::start, {"step.length"}, "starts"));
  const test::Ground level([](double, double) { return 0.0; });
  const auto made = walk(libraries, test::prints_of({}), level, {});
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, "walk-library");
}

// Would fail if a print's off, and the keytime beside the motion, were when the ball leaves: the
// walk's double support would seem to be a third of what it is.
TEST(StepTimes, FeetAreOffWhenTheToesOfTheExamplesLeave) {
  const parametric::Library& library = test::walking().front().library();
  double first = 1, last = 0;  // of the time between the other foot's strikes
  for (const parametric::Example& example : library.examples) {
    const auto time_of = [&](const char* name) {
      return example.keytimes[static_cast<std::size_t>(std::ranges::find(library.keytimes, name) -
                                                       library.keytimes.begin())];
    };
    const double start = example.keytimes.front();
    const double part = (time_of("swing_off") - start) / (time_of("swing_strike") - start);
    first = std::min(first, part);
    last = std::max(last, part);
  }
  const test::Ground level([](double, double) { return 0.0; });
  const auto made = walk(test::walking(), test::prints_of({.steps = 8}), level, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  const std::vector<GroundedPrint>& prints = made->details.prints;
  for (std::size_t k = 2; k + 3 < prints.size(); ++k) {
    const double step = prints[k + 2].strike - prints[k + 1].strike;
    const double part = (prints[k].off - prints[k + 1].strike) / step;
    // The tip of the toes leaves its print up to 30 ms before that.
    EXPECT_GT(part, first - 0.06) << k;
    EXPECT_LT(part, last + 0.01) << k;
  }
}

}  // namespace
}  // namespace krok::gait
