// If these fail, steps backward, to the side or on the spot get into libraries of walks, and blends
// of them are steps that nobody makes.

#include <gmock/gmock.h>

#include "walks.h"

namespace krok::parametric {
namespace {

using samples::WalkOptions;
using testing::HasSubstr;

test::KeyedWalk walk(double length, double turn, bool backward) {
  WalkOptions options;
  options.steps = 10;
  options.step_length = length;
  options.turn = turn;
  options.backward = backward;
  return test::keyed_walk(options);
}

// Every joint turned about the vertical through itself: positions go where they went, but the body
// and its feet face a quarter turn to the left, so that it walks to its right.
test::KeyedWalk sideways() {
  test::KeyedWalk made = walk(0.4, 0, false);
  Clip& clip = made.walk.clip;
  const Eigen::Quaternionf turn = axis_rotation(Axis::y, kPi / 2).cast<float>();
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (auto& orientation : clip.frame_orientations(f)) orientation = turn * orientation;
  }
  return made;
}

std::size_t steps_of(const std::vector<test::KeyedWalk>& walks, StepGait gait, bool mirror = true,
                     FootSide swing = FootSide::left) {
  std::vector<Walk> given;
  for (const test::KeyedWalk& one : walks) {
    given.push_back({"walk", &one.walk.clip, &one.keys, &one.found});
  }
  const std::vector<std::string> length = {"step.length"};
  CutOptions options;
  options.gait = gait;
  options.mirror = mirror;
  options.swing = swing;
  options.outlier = 0;
  const auto cut = cut_steps(given, find_roles(walks.front().walk.clip.skeleton), length, options);
  return cut.ok() ? cut->library.examples.size() : 0;
}

struct Counts {
  std::size_t forward, backward, side, side_closing, turns, turns_closing;
  bool operator==(const Counts&) const = default;
};
void PrintTo(const Counts& c, std::ostream* out) {
  *out << c.forward << " forward, " << c.backward << " backward, " << c.side << " + "
       << c.side_closing << " to the side, " << c.turns << " + " << c.turns_closing << " turning";
}
Counts counts(const std::vector<test::KeyedWalk>& walks) {
  return {steps_of(walks, StepGait::walk), steps_of(walks, StepGait::backward),
          steps_of(walks, StepGait::side), steps_of(walks, StepGait::side_closing),
          steps_of(walks, StepGait::turn), steps_of(walks, StepGait::turn_closing)};
}

std::vector<test::KeyedWalk> one(test::KeyedWalk walk) {
  std::vector<test::KeyedWalk> walks;
  walks.push_back(std::move(walk));
  return walks;
}

TEST(StepDirection, EachGaitTakesItsOwnSteps) {
  EXPECT_EQ(counts(one(walk(0.6, 0, false))), (Counts{10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(counts(one(walk(0.6, 0.4, false))), (Counts{10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(counts(one(walk(0, 0, false))), (Counts{9, 0, 0, 0, 0, 0}));
  EXPECT_EQ(counts(one(walk(0.6, 0, true))), (Counts{0, 9, 0, 0, 0, 0}));
  EXPECT_EQ(counts(one(walk(0, 0.6, false))), (Counts{0, 0, 0, 0, 5, 4}));
  EXPECT_EQ(counts(one(sideways())), (Counts{0, 0, 4, 5, 0, 0}));
}

// The body goes to its right: the right foot leads.
TEST(StepDirection, OneFootLeads) {
  const auto walks = one(sideways());
  EXPECT_EQ(steps_of(walks, StepGait::side, false, FootSide::right), 4u);
  EXPECT_EQ(steps_of(walks, StepGait::side, false, FootSide::left), 0u);
  EXPECT_EQ(steps_of(walks, StepGait::side_closing, false, FootSide::left), 5u);
  // A turn to the left, of the left foot.
  const auto turns = one(walk(0, 0.6, false));
  EXPECT_EQ(steps_of(turns, StepGait::turn, false, FootSide::left), 5u);
  EXPECT_EQ(steps_of(turns, StepGait::turn, false, FootSide::right), 0u);
}

// Of captures of all kinds, each library takes its own; lengths of backward steps are negative.
TEST(StepDirection, MixedCapturesDoNotMix) {
  std::vector<test::KeyedWalk> walks;
  walks.push_back(walk(0.6, 0, false));
  walks.push_back(walk(0.5, 0, true));
  walks.push_back(walk(0, 0.6, false));
  walks.push_back(sideways());
  EXPECT_EQ(counts(walks), (Counts{10, 9, 4, 5, 5, 4}));
  CutOptions options;
  options.outlier = 0;
  StepLibrary cut = test::library_of(walks, {"step.length"}, options);
  for (const Example& example : cut.library.examples) EXPECT_GT(example.parameters[0], 0.4);
  EXPECT_EQ(cut.dropped.size(), 27u);
  EXPECT_THAT(commonest_reasons(cut.dropped), HasSubstr("9 as it goes backward"));
  options.gait = StepGait::backward;
  cut = test::library_of(walks, {"step.length"}, options);
  for (const Example& example : cut.library.examples) EXPECT_LT(example.parameters[0], -0.4);
}

}  // namespace
}  // namespace krok::parametric
