// If these fail, keytimes that nobody could have walked are handed on without a word: steps without
// double support at a stroll, a foot that is down all the time, strikes that were lost.

#include "contacts/gait_metrics.h"

#include <gtest/gtest.h>

#include "events.h"

namespace krok {
namespace {

// Strikes of a steady gait and offs after `stance` of the cycle, seconds.
std::vector<Keytime> steady(double cycle, double stance_left, double stance_right) {
  std::vector<Keytime> keys;
  for (int i = 0; i < 6; ++i) {
    const double left = i * cycle, right = (i + 0.5) * cycle;
    keys.push_back({left, "left_strike"});
    keys.push_back({left + stance_left * cycle, "left_off"});
    keys.push_back({right, "right_strike"});
    keys.push_back({right + stance_right * cycle, "right_off"});
  }
  std::ranges::stable_sort(keys, {}, &Keytime::time);
  return keys;
}

bool is_told(const std::vector<Keytime>& keys, double speed) {
  const Diagnostics warnings = check_gait(gait_metrics(keys), speed, 0.86);
  for (const Diagnostic& warning : warnings) EXPECT_EQ(warning.code, "gait-implausible");
  return !warnings.empty();
}

TEST(GaitPlausibility, WhatPeopleDoIsNotQuestioned) {
  EXPECT_FALSE(is_told(steady(1.1, 0.62, 0.61), 1.3));
  EXPECT_FALSE(is_told(steady(1.6, 0.72, 0.72), 0.5));
  EXPECT_FALSE(is_told(steady(0.7, 0.35, 0.36), 3.5));
  EXPECT_FALSE(is_told(steady(0.6, 0.4, 0.4), 0));  // jogging on the spot
  EXPECT_FALSE(is_told({}, 1));
}

TEST(GaitPlausibility, WhatNobodyDoesIsTold) {
  EXPECT_TRUE(is_told(steady(1.46, 0.45, 0.46), 0.8));  // no double support at 82 steps a minute
  EXPECT_TRUE(is_told(steady(0.7, 0.65, 0.66), 3.5));
  EXPECT_TRUE(is_told(steady(1.1, 0.62, 0.4), 1.3));
  EXPECT_TRUE(is_told(steady(0.3, 0.6, 0.6), 1.3));
  EXPECT_TRUE(is_told(steady(1.1, 0.95, 0.95), 1.3));
}

// Missing events only lower the cadence.
TEST(GaitPlausibility, TooFastHintsAtTheFrameRate) {
  const auto hint = [](double cycle, double stance) {
    return check_gait(gait_metrics(steady(cycle, stance, stance)), 1.3, 0.86).at(0).hint;
  };
  EXPECT_NE(hint(0.28, 0.6).find("--fps"), std::string::npos);
  EXPECT_EQ(hint(1.1, 0.95).find("--fps"), std::string::npos);
}

// Found in the motion as well as given.
TEST(GaitPlausibility, GeneratedWalksAreNotQuestioned) {
  for (const double length : {0.35, 0.7, 0.9}) {
    samples::WalkOptions options;
    options.step_length = length;
    const auto made = samples::make_walk(options);
    ASSERT_TRUE(made.ok());
    const RoleMap roles = find_roles(made->clip.skeleton);
    const auto found = find_contacts(made->clip, roles);
    ASSERT_TRUE(found.ok());
    for (const Diagnostic& warning : find_gait(made->clip, roles, *found).warnings) {
      EXPECT_NE(warning.code, "gait-implausible") << warning.message;
    }
  }
}

}  // namespace
}  // namespace krok
