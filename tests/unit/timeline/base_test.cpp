// If these fail, motions that are played one after the other are not themselves any more: cut at
// the wrong place, jumping where rounds begin, or at the wrong speed.

#include <gtest/gtest.h>

#include "motion/loop.h"
#include "unit/timeline/mixed_walks.h"

namespace krok::timeline {
namespace {

TEST(Base, AMotionAloneComesBackBitForBit) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  const Mixed result = mixed({0, {played(0)}, {}}, {source_of(walk)});
  ASSERT_EQ(result.clip.frame_count(), walk.clip.frame_count());
  EXPECT_EQ(result.clip.rate, walk.clip.rate);
  for (int f = 0; f < walk.clip.frame_count(); ++f) {
    EXPECT_TRUE(same_frame(result.clip, f, walk.clip, f)) << f;
  }
  // And so do its keys.
  ASSERT_EQ(result.keys.keytimes.size(), walk.keys.keytimes.size());
  for (std::size_t k = 0; k < walk.keys.keytimes.size(); ++k) {
    EXPECT_EQ(result.keys.keytimes[k].name, walk.keys.keytimes[k].name);
    EXPECT_NEAR(result.keys.keytimes[k].time, walk.keys.keytimes[k].time, 1e-9);
  }
  std::size_t lasting = 0;
  for (const Contact& contact : walk.keys.contacts) {
    lasting += contact.end - contact.start >= 1 / walk.clip.rate ? 1 : 0;
  }
  EXPECT_EQ(result.keys.contacts.size(), lasting);
}

TEST(Base, CutInTwoAndPutTogetherItIsItself) {
  const KeyedWalk walk = keyed_walk(quick_walk());
  for (const Align align : {Align::root, Align::stance}) {
    Timeline timeline{0, {played(0), played(0)}, {}};
    timeline.base[0].play.to = seconds(1.0);
    timeline.base[1].play.from = seconds(1.0);
    timeline.base[1].change.align = align;
    const Mixed result = mixed(timeline, {source_of(walk)});
    ASSERT_EQ(result.clip.frame_count(), walk.clip.frame_count());
    EXPECT_LT(farthest(result.clip, walk.clip), 1e-5);
    EXPECT_LT(result.changes[0].angle, 1e-6);
    EXPECT_EQ(result.changes[0].on_feet, align == Align::stance);
    EXPECT_FALSE(result.changes[0].pops());
    EXPECT_EQ(result.keys.keytimes.size(), walk.keys.keytimes.size());
  }
}

TEST(Base, GoesOnWhereTheItemBeforeLeftTheActor) {
  samples::WalkOptions options = slow_walk();
  options.turn = 0.3;
  const KeyedWalk walk = keyed_walk(options);
  Timeline timeline{0, {played(0), played(0)}, {}};
  timeline.base[0].play.to = seconds(1.5);
  timeline.base[1].play.from = seconds(0.5);
  timeline.base[1].change.align = Align::root;
  const Mixed result = mixed(timeline, {source_of(walk)});
  const int carrier = carrying_joint(find_roles(walk.clip.skeleton));
  const int join = static_cast<int>(std::lround(1.5 * walk.clip.rate));
  const GroundFrame left = ground_frame(walk.clip, carrier, join);
  const GroundFrame entered = ground_frame(result.clip, carrier, join);
  EXPECT_NEAR(entered.x, left.x, 1e-5);
  EXPECT_NEAR(entered.z, left.z, 1e-5);
  EXPECT_NEAR(wrapped(entered.heading - left.heading), 0, 1e-5);
  // What follows is the second item's, moved as a whole.
  const Transform moved =
      left.to_world() *
      ground_frame(walk.clip, carrier, static_cast<int>(std::lround(0.5 * walk.clip.rate)))
          .to_world()
          .inverse();
  for (int k = 0; k < 60; ++k) {
    const int f = static_cast<int>(std::lround(0.5 * walk.clip.rate)) + k;
    for (std::size_t j = 0; j < walk.clip.skeleton.names.size(); ++j) {
      const Vec3 expected = moved * walk.clip.frame_positions(f)[j].cast<double>();
      EXPECT_LT((result.clip.frame_positions(join + k)[j].cast<double>() - expected).norm(), 1e-5);
    }
  }
}

TEST(Base, SpeedsAndBackwards) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Timeline timeline{0, {played(0)}, {}};
  timeline.base[0].play.speed = 2;
  const Mixed twice = mixed(timeline, {source_of(walk)});
  ASSERT_EQ(twice.clip.frame_count(), (walk.clip.frame_count() + 1) / 2);
  for (int f = 0; f < twice.clip.frame_count(); ++f) {
    EXPECT_TRUE(same_frame(twice.clip, f, walk.clip, 2 * f)) << f;
  }
  EXPECT_NEAR(twice.keys.keytimes[1].time, 0.5 * walk.keys.keytimes[1].time, 1e-9);

  timeline.base[0].play.speed = -1;
  const Mixed back = mixed(timeline, {source_of(walk)});
  const int last = walk.clip.frame_count() - 1;
  ASSERT_EQ(back.clip.frame_count(), walk.clip.frame_count());
  for (int f = 0; f <= last; ++f) {
    EXPECT_TRUE(same_frame(back.clip, f, walk.clip, last - f)) << f;
  }
  // Strikes would be lift-offs; what stands stands.
  EXPECT_TRUE(back.keys.keytimes.empty());
  EXPECT_FALSE(back.keys.contacts.empty());
}

// lib/motion's repeated() is another program for the same.
TEST(Base, RoundsGoOnInPlace) {
  samples::WalkOptions options = quick_walk();
  options.turn = 0.2;
  const KeyedWalk walk = keyed_walk(options);
  const auto looped =
      loop(walk.clip, carrying_joint(find_roles(walk.clip.skeleton)), {.turn = LoopTurn::keep});
  ASSERT_TRUE(looped.ok());
  const auto expected = repeated(looped->clip, looped->displacement, 4);
  ASSERT_TRUE(expected.ok());
  Timeline timeline{0, {played(0)}, {}};
  timeline.base[0].play.rounds = 4;
  const std::vector<Source> sources = {{"loop", &looped->clip, nullptr, {}}};
  const Mixed result = mixed(timeline, sources);
  ASSERT_EQ(result.clip.frame_count(), expected->frame_count());
  EXPECT_LT(farthest(result.clip, *expected), 2e-5);
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_EQ(result.items[0].rounds, 4);

  // Until a time in the middle of a round.
  timeline.base[0].play.rounds = 0;
  timeline.base[0].play.until = seconds(2.2 * looped->clip.duration());
  const Mixed until = mixed(timeline, sources);
  EXPECT_EQ(
      until.clip.frame_count(),
      static_cast<int>(std::floor(2.2 * looped->clip.duration() * walk.clip.rate + 1e-3)) + 1);
  EXPECT_LT(farthest(until.clip, *expected), 2e-5);
}

TEST(Base, WhatFollowsEndsAnEndlessLoop) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Timeline timeline{0, {played(0), changed(0, ChangeKind::crossfade, 0.5)}, {}};
  timeline.base[0].play.rounds = 0;
  timeline.base[1].at = seconds(2.5 * walk.clip.duration());
  const Mixed result = mixed(timeline, {source_of(walk)});
  EXPECT_EQ(result.items[0].rounds, 3);
  EXPECT_NEAR(result.items[0].end, 2.5 * walk.clip.duration() + 0.5, 1e-9);
  EXPECT_NEAR(result.items[1].start, 2.5 * walk.clip.duration(), 1e-9);
  // The walk repeats, so that its seams are none: contacts go on through them.
  for (const Contact& contact : result.keys.contacts) {
    EXPECT_GE(contact.end - contact.start, 1 / walk.clip.rate);
  }
}

TEST(Base, RoundsThatJumpAreTold) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Timeline timeline{0, {played(0)}, {}};
  timeline.base[0].play.from = seconds(0.1);
  timeline.base[0].play.to = seconds(0.6);
  timeline.base[0].play.rounds = 2;
  const Mixed result = mixed(timeline, {source_of(walk)});
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(result.warnings[0].code, "timeline-seam");
}

// A walk that ends a hand's breadth higher than it begins falls each round; no angle tells.
TEST(Base, RoundsWhoseHipsJumpAreTold) {
  KeyedWalk walk = keyed_walk(slow_walk());
  const int last = walk.clip.frame_count() - 1;
  // The last tenth of a second rises steeply, all of the figure as one.
  for (int f = last - 5; f <= last; ++f) {
    for (Vec3f& place : walk.clip.frame_positions(f)) {
      place.y() += 0.04f * static_cast<float>(f - last + 6);
    }
  }
  Timeline timeline{0, {played(0)}, {}};
  timeline.base[0].play.rounds = 2;
  const Mixed result = mixed(timeline, {source_of(walk)});
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(result.warnings[0].code, "timeline-seam");
  EXPECT_FALSE(result.warnings[0].joint.empty());
}

TEST(Base, ItsOwnRateAndPlace) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Timeline timeline{30, {played(0)}, {}};
  timeline.base[0].place = GroundFrame{2, -3, 1};
  const Mixed result = mixed(timeline, {source_of(walk)});
  EXPECT_EQ(result.clip.rate, 30);
  EXPECT_EQ(result.clip.frame_count(),
            static_cast<int>(std::floor(walk.clip.duration() * 30 + 1e-3)) + 1);
  const GroundFrame place =
      ground_frame(result.clip, carrying_joint(find_roles(walk.clip.skeleton)), 0);
  EXPECT_NEAR(place.x, 2, 1e-5);
  EXPECT_NEAR(place.z, -3, 1e-5);
  EXPECT_NEAR(place.heading, 1, 1e-5);
}

TEST(Base, PartsByName) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Source source = source_of(walk);
  source.parts = {{"middle", frames(30), frames(60), 0.5, false},
                  {"again", frames(30), frames(60), 1, true}};
  Timeline timeline{0, {played(0)}, {}};
  timeline.base[0].play.part = "middle";
  EXPECT_EQ(mixed(timeline, {source}).clip.frame_count(), 61);
  // One that loops does so only where something ends it.
  timeline.base[0].play.part = "again";
  EXPECT_EQ(mixed(timeline, {source}).clip.frame_count(), 31);
  timeline.base[0].play.until = frames(100);
  EXPECT_EQ(mixed(timeline, {source}).clip.frame_count(), 101);
  timeline.base[0].play.part = "gone";
  const auto gone = try_mix(timeline, {source});
  ASSERT_FALSE(gone.ok());
  EXPECT_EQ(gone.error().code, "timeline-source");
  EXPECT_NE(gone.error().hint.find("middle, again"), std::string::npos);
}

TEST(Base, APoseIsHeldUntilSomethingEndsIt) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Timeline timeline{0, {played(0)}, {}};
  timeline.base[0].play.from = timeline.base[0].play.to = frames(20);
  const auto endless = try_mix(timeline, {source_of(walk)});
  ASSERT_FALSE(endless.ok());
  EXPECT_EQ(endless.error().code, "timeline-endless");
  timeline.base[0].play.until = frames(40);
  const Mixed held = mixed(timeline, {source_of(walk)});
  ASSERT_EQ(held.clip.frame_count(), 41);
  for (int f = 0; f < 41; ++f) EXPECT_TRUE(same_frame(held.clip, f, walk.clip, 20));
}

TEST(Base, OneFrameAndOneJoint) {
  const Clip still = turning(0, 30, [](double) { return 0.3; });
  const std::vector<Source> sources = {{"still", &still, nullptr, {}}};
  for (const ChangeKind kind :
       {ChangeKind::cut, ChangeKind::crossfade, ChangeKind::smooth, ChangeKind::inertial}) {
    Timeline timeline{30, {played(0), changed(0, kind, 0.5)}, {}};
    timeline.base[0].play.until = seconds(1);
    timeline.base[1].play.until = seconds(2);
    const Mixed result = mixed(timeline, sources);
    EXPECT_EQ(result.clip.frame_count(), 61);
    for (int f = 0; f < 61; ++f) EXPECT_NEAR(angle_of(result.clip, f), 0.3, 1e-6);
  }
}

struct Refused {
  const char* code;
  std::function<void(Timeline&)> change;
};

TEST(Base, WhatCannotBePlayedIsRefusedWithItsPlace) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  const double lasts = walk.clip.duration();
  const auto item = [](Timeline& t, std::size_t i = 0) -> BaseItem& { return t.base[i]; };
  const Refused cases[] = {
      {"timeline-empty", [&](Timeline& t) { t.base.clear(); }},
      {"timeline-source", [&](Timeline& t) { item(t).play.source = 7; }},
      {"timeline-source", [&](Timeline& t) { item(t).play.source = -1; }},
      {"timeline-time", [&](Timeline& t) { item(t).play.from = seconds(lasts + 1); }},
      {"timeline-time", [&](Timeline& t) { item(t).play.to = seconds(-0.1); }},
      {"timeline-time", [&](Timeline& t) { item(t).play.to = seconds(std::nan("")); }},
      {"timeline-time",
       [&](Timeline& t) {
         item(t).play.from = seconds(1);
         item(t).play.to = seconds(0.5);
       }},
      {"timeline-time", [&](Timeline& t) { item(t).play.speed = 0; }},
      {"timeline-time", [&](Timeline& t) { item(t).play.speed = HUGE_VAL; }},
      {"timeline-limit", [&](Timeline& t) { item(t).play.rounds = 1'000'000; }},
      {"timeline-limit", [&](Timeline& t) { item(t).play.rounds = -1; }},
      {"timeline-time", [&](Timeline& t) { item(t).at = seconds(1); }},
      {"timeline-time", [&](Timeline& t) { item(t).play.until = seconds(lasts + 1); }},
      {"timeline-time", [&](Timeline& t) { item(t).play.until = seconds(-1); }},
      {"timeline-endless", [&](Timeline& t) { item(t).play.rounds = 0; }},
      {"timeline-endless", [&](Timeline& t) { item(t, 1).play.rounds = 0; }},
      {"timeline-time", [&](Timeline& t) { item(t, 1).at = seconds(lasts + 1); }},
      {"timeline-time", [&](Timeline& t) { item(t, 1).at = seconds(-1); }},
      {"timeline-time", [&](Timeline& t) { item(t, 1).at = seconds(std::nan("")); }},
      {"timeline-time", [&](Timeline& t) { item(t, 1).change.kind = ChangeKind::smooth; }},
      {"timeline-time",
       [&](Timeline& t) {
         item(t, 1).change = {ChangeKind::crossfade, lasts + 1, {}, Sync::clock};
       }},
      {"timeline-time",
       [&](Timeline& t) {
         item(t, 1).change = {ChangeKind::inertial, lasts + 1, {}, Sync::clock};
       }},
      {"timeline-time",
       [&](Timeline& t) {
         item(t, 1).change = {ChangeKind::crossfade, std::nan(""), {}, Sync::clock};
       }},
      {"timeline-sync",
       [&](Timeline& t) {
         item(t, 1).change = {ChangeKind::crossfade, 0.2, {}, Sync::keytimes};
         item(t, 1).play.speed = -1;
       }},
      {"timeline-time",
       [&](Timeline& t) {
         item(t).marks = {{"late", seconds(100), false}};
       }},
      {"clip-rate", [&](Timeline& t) { t.rate = -1; }},
      {"clip-rate", [&](Timeline& t) { t.rate = 1e8; }},
  };
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    Timeline timeline{0, {played(0), played(0)}, {}};
    timeline.base[0].where.line = 11;
    timeline.base[1].where.line = 12;
    cases[i].change(timeline);
    const auto result = try_mix(timeline, {source_of(walk)});
    ASSERT_FALSE(result.ok()) << i;
    EXPECT_EQ(result.error().code, cases[i].code) << i << " " << result.error().message;
    const bool of_item = std::string(cases[i].code).starts_with("timeline-") &&
                         std::string(cases[i].code) != "timeline-empty";
    EXPECT_EQ(result.error().where.line > 10, of_item) << i << " " << result.error().message;
  }
}

TEST(Base, OtherSkeletonsAndEmptyMotionsAreRefused) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  const Clip joint = turning(1, 30, [](double t) { return t; });
  const auto other =
      try_mix({0, {played(0), played(1)}, {}}, {source_of(walk), {"joint", &joint, nullptr, {}}});
  ASSERT_FALSE(other.ok());
  EXPECT_EQ(other.error().code, "timeline-skeleton");
  EXPECT_NE(other.error().hint.find("krok-retarget"), std::string::npos);
  Clip empty;
  empty.skeleton = walk.clip.skeleton;
  const auto none =
      try_mix({0, {played(0)}, {}}, {source_of(walk), {"empty", &empty, nullptr, {}}});
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, "timeline-empty");
}

}  // namespace
}  // namespace krok::timeline
