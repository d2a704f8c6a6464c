// If these fail, a library of runs cannot be run with, runners slide or never leave the ground, or
// a walk does not turn into a run and back where it becomes faster.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/index.h"
#include "gait/plan_prints.h"
#include "motion/hips_root.h"
#include "parametric/thin_out.h"
#include "walkers.h"

namespace krok::gait {
namespace {

constexpr double kStepTime = 0.45;  // seconds

// Steps of 0.75 to 0.95 m whose stance foot is off some 0.2 of their time before the other strikes.
StepLibrary library_of_runs() {
  std::vector<parametric::test::KeyedWalk> runs;
  for (const double length : {0.75, 0.85, 0.95}) {
    samples::WalkOptions options;
    options.steps = 8;
    options.step_length = length;
    options.cadence = 60 / kStepTime;
    auto& keyed = runs.emplace_back(parametric::test::keyed_walk(options));
    const double shift = 0.4 * kStepTime;
    for (Keytime& key : keyed.keys.keytimes) {
      if (key.name.ends_with("off")) key.time -= shift;
    }
    std::erase_if(keyed.keys.keytimes, [](const Keytime& key) { return key.time < 0; });
    std::ranges::sort(keyed.keys.keytimes, {}, &Keytime::time);
  }
  parametric::CutOptions options;
  options.gait = parametric::StepGait::run;
  options.outlier = 0;
  auto library = parametric::test::library_of(runs, {"step.length"}, options).library;
  std::vector<parametric::Example> kept;
  for (const int i : parametric::thin_out(library, 0.1)) kept.push_back(library.examples[at(i)]);
  library.examples = std::move(kept);
  return test::walking_library(std::move(library), "runs");
}

std::vector<StepLibrary> walks_and_runs() {
  std::vector<StepLibrary> libraries;
  libraries.push_back(test::walking_library());
  libraries.push_back(library_of_runs());
  return libraries;
}

const test::Ground& level() {
  static const test::Ground kGround([](double, double) { return 0.0; });
  return kGround;
}

double off_of(const WalkDetails& details, std::size_t print) {
  return details.prints[print].off;
}

TEST(Runs, FeetAreOnTheirPrintsAndOffBeforeTheNextStrikes) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(library_of_runs());
  const auto prints = test::prints_of({.steps = 9, .length = 0.85});
  const auto made = walk(libraries, prints, level(), {.variation = 0});
  ASSERT_TRUE(made.ok()) << made.error().message;
  const WalkDetails& details = made->details;
  for (const StepReport& step : details.steps) EXPECT_LT(step.missed, 1e-5);
  for (std::size_t k = 2; k + 3 < prints.size(); ++k) {
    const double flight = details.prints[k + 1].strike - off_of(details, k);
    EXPECT_GT(flight, 0.05) << k;
    EXPECT_LT(flight, 0.3) << k;
  }
  // The ball does not move from the strike, when the foot is flat, to its off.
  for (const Contact& contact : details.keys.contacts) {
    const Clip& clip = made->clip;
    for (int f = 0; f < clip.frame_count(); ++f) {
      const double time = f / clip.rate;
      if (time < contact.start || time > contact.end) continue;
      const Vec3 place = clip.frame_positions(f)[at(contact.joint)].cast<double>();
      EXPECT_LT((place - contact.place).norm(), 1e-4) << f;
    }
  }
}

TEST(Runs, OfALongRunPartsAreTheSameAsAll) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(library_of_runs());
  const auto prints = test::prints_of({.steps = 140, .length = 0.85, .turn = 0.01});
  const auto whole = walk(libraries, prints, level(), {}, 1);
  ASSERT_TRUE(whole.ok()) << whole.error().message;
  // From the middle of the second block of steps on.
  const auto parts = Walk::plan(libraries, prints, level(), {});
  ASSERT_TRUE(parts.ok());
  const FrameSource& frames = parts->frames();
  const int first = frames.frame_count / 2, count = 30;
  const std::size_t joints = frames.skeleton.names.size();
  std::vector<Vec3f> positions(at(count) * joints);
  std::vector<Quatf> orientations(at(count) * joints);
  ASSERT_TRUE(frames.read(first, count, positions, orientations).ok());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_EQ(positions[i], whole->clip.positions[at(first) * joints + i]);
  }
}

TEST(Runs, AWalkBecomesARunAndAWalkAgain) {
  const auto libraries = walks_and_runs();
  auto options = usual_steps(libraries);
  ASSERT_TRUE(options.ok());
  for (const double speed : {1.1, 1.95, 1.1}) {
    const auto length = step_length_at_speed(libraries, speed);
    ASSERT_TRUE(length.ok()) << length.error().message;
    options->step_lengths.push_back(*length);
    options->max_step = std::max(options->max_step, *length);
    options->min_step = std::min(options->min_step, *length);
  }
  const auto path = Path::create(std::vector<PathPoint>{{0, 0, {}}, {0, 20, {}}});
  ASSERT_TRUE(path.ok());
  const auto planned = plan_prints(*path, level(), *options);
  ASSERT_TRUE(planned.ok()) << planned.error().message;
  const auto made = walk(libraries, planned->prints, level(), {.variation = 0});
  ASSERT_TRUE(made.ok()) << made.error().message;
  std::string gaits;
  for (const StepReport& step : made->details.steps) {
    EXPECT_LT(step.missed, 1e-5);
    if (gaits.empty() || !gaits.ends_with(step.library)) gaits += " " + step.library;
  }
  EXPECT_EQ(gaits, " walks runs walks");
  // The hips neither lurch nor stop where the gait changes.
  const auto hips = at(carrying_joint(find_roles(made->clip.skeleton)));
  const std::vector<StepReport>& steps = made->details.steps;
  const int from = static_cast<int>(steps[1].end * made->clip.rate);
  const int to = static_cast<int>(steps[steps.size() - 2].start * made->clip.rate);
  for (int f = from; f < to; ++f) {
    const Vec3f way = made->clip.frame_positions(f + 1)[hips] - made->clip.frame_positions(f)[hips];
    EXPECT_GT(way.z() * made->clip.rate, 0.6) << f;
    EXPECT_LT(way.z() * made->clip.rate, 2.8) << f;
  }
}

TEST(Runs, StepsOfASpeedLastAsLongAsThatTakes) {
  const auto libraries = walks_and_runs();
  for (const double speed : {1.7, 1.9, 2.1}) {
    const auto length = step_length_at_speed(libraries, speed);
    ASSERT_TRUE(length.ok()) << length.error().message;
    EXPECT_NEAR(*length / kStepTime, speed, 0.05 * speed);
  }
  const auto none = step_length_at_speed(libraries, 7);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, "walk-speed");
}

}  // namespace
}  // namespace krok::gait
