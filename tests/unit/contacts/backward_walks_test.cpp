// If these fail, strikes and offs are timed by the way a foot lands in forward walks alone: steps
// of backward walks are cut elsewhere, and a motion and its mirror image get other keytimes.

#include <gtest/gtest.h>

#include "events.h"
#include "motion/mirror.h"

namespace krok {
namespace {

using test::WalkHits;

WalkHits backward_hits(double rate) {
  WalkHits hits;
  for (const double length : {0.35, 0.5, 0.65}) {
    for (const double turn : {0.0, 0.2}) {
      samples::WalkOptions options;
      options.steps = 12;
      options.step_length = length;
      options.turn = turn;
      options.rate = rate;
      options.backward = true;
      const auto made = samples::make_walk(options);
      EXPECT_TRUE(made.ok());
      match(*made, test::keytimes_of(made->clip), hits);
    }
  }
  return hits;
}

// The toes land first, and the foot is dragged off its heel.
TEST(BackwardWalks, EventsAreWithinAFrame) {
  for (const double rate : {30.0, 60.0, 120.0}) {
    const WalkHits hits = backward_hits(rate);
    EXPECT_GT(hits.strikes.known, 50) << rate;
    EXPECT_GE(hits.strikes.share(), 0.98) << rate;
    EXPECT_GE(hits.offs.share(), 0.8) << rate;
    EXPECT_LE(hits.offs.rms(), 0.016) << rate;
    EXPECT_LE(hits.strikes.extra + hits.offs.extra, 2) << rate;
  }
}

// A mirrored walk has the other foot's events at the same times.
TEST(BackwardWalks, MirroredWalksHaveTheSameEvents) {
  for (const bool backward : {false, true}) {
    samples::WalkOptions options;
    options.turn = 0.1;
    options.backward = backward;
    const auto made = samples::make_walk(options);
    ASSERT_TRUE(made.ok());
    const Clip& clip = made->clip;
    const Clip other = mirror(clip, find_mirror_pairs(clip.skeleton, find_roles(clip.skeleton)));
    const auto keys = test::keytimes_of(clip), mirrored = test::keytimes_of(other);
    ASSERT_GT(keys.size(), 10u);
    for (const auto& [name, partner] :
         {std::pair{"left_strike", "right_strike"}, std::pair{"left_off", "right_off"},
          std::pair{"right_strike", "left_strike"}, std::pair{"right_off", "left_off"}}) {
      const auto times = test::times_of(keys, name), same = test::times_of(mirrored, partner);
      ASSERT_EQ(times.size(), same.size()) << name;
      for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], same[i], 1e-4) << name;
    }
  }
}

}  // namespace
}  // namespace krok
