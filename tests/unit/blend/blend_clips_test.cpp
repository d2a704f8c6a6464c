// If these fail, a blend of motions is not what lies between them: its feet slide or strike at the
// wrong moment, turns do not blend, or a motion alone does not come back.

#include "blend/blend_clips.h"

#include <gtest/gtest.h>

#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "unit/blend/blended_walks.h"

namespace krok::blend {
namespace {

constexpr double kRounding = 5e-6;  // metres: floats relative to the parent, down a chain of joints

TEST(Blend, OfAMotionWithItselfIsItself) {
  const KeyedWalk walk = keyed_walk(quick_walk());
  for (const Warp warp : {Warp::pchip, Warp::linear}) {
    for (const Align align : {Align::root, Align::stance, Align::none}) {
      for (const double weight : {0.5, 0.3, 1.4}) {
        const std::vector<BlendInput> inputs = {input_of(walk, WeightCurve::constant(weight)),
                                                input_of(walk, WeightCurve::constant(1 - weight))};
        for (const Correspondence& moments : {keytimes_of(inputs), ends_of(inputs)}) {
          const Blended result = blended(inputs, moments, {.warp = warp, .align = align});
          EXPECT_EQ(result.clip.frame_count(), walk.clip.frame_count());
          EXPECT_LT(farthest(result.clip, walk.clip), kRounding)
              << weight << " " << static_cast<int>(align) << " " << static_cast<int>(warp);
          EXPECT_LT(result.widest_spread, 1e-3);
        }
      }
    }
  }
}

TEST(Blend, WithAllWeightOnOneIsThatOne) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<BlendInput> first = {input_of(slow, WeightCurve::constant(1)),
                                         input_of(quick, WeightCurve::constant(0))};
  const std::vector<BlendInput> second = {input_of(slow, WeightCurve::constant(0)),
                                          input_of(quick, WeightCurve::constant(1))};
  for (const Align align : {Align::root, Align::stance, Align::none}) {
    const Blended slowly = blended(first, keytimes_of(first), {.align = align});
    EXPECT_EQ(slowly.clip.frame_count(), slow.clip.frame_count());
    EXPECT_LT(farthest(slowly.clip, slow.clip), kRounding);
    const Blended quickly = blended(second, keytimes_of(second), {.align = align});
    EXPECT_EQ(quickly.clip.frame_count(), quick.clip.frame_count());
    EXPECT_LT(farthest(quickly.clip, quick.clip), kRounding);
  }
}

TEST(Blend, KeytimesAreWeightedSums) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<BlendInput> inputs = {input_of(slow, WeightCurve::constant(0.25)),
                                          input_of(quick, WeightCurve::constant(0.75))};
  const Correspondence moments = keytimes_of(inputs);
  const Blended result = blended(inputs, moments);
  ASSERT_GE(result.keys.keytimes.size(), 10u);
  const std::size_t skipped = moments.names.front() == "begin" ? 1 : 0;
  for (std::size_t k = 0; k < result.keys.keytimes.size(); ++k) {
    const auto since = [&](std::size_t m) {
      return moments.times[m][k + skipped] - moments.times[m][0];
    };
    EXPECT_EQ(result.keys.keytimes[k].name, moments.names[k + skipped]);
    EXPECT_NEAR(result.keys.keytimes[k].time,
                std::min(0.25 * since(0) + 0.75 * since(1), result.clip.duration()), 1e-9);
  }
  EXPECT_TRUE(check(result.keys, result.clip.skeleton, result.clip.duration()).ok());
  EXPECT_FALSE(result.keys.contacts.empty());
}

// Would fail if the contact that begins last were the only one that is looked at.
TEST(Blend, AContactInsideALongerOneDoesNotEndIt) {
  KeyedWalk walk = keyed_walk(quick_walk());
  const double rate = walk.clip.rate;
  walk.keys.contacts = {{2, 10 / rate, 50 / rate, {}}, {2, 20 / rate, 30 / rate, {}}};
  const std::vector<BlendInput> inputs = {input_of(walk, WeightCurve::constant(0.5)),
                                          input_of(walk, WeightCurve::constant(0.5))};
  const Blended result = blended(inputs, keytimes_of(inputs));
  ASSERT_EQ(result.keys.contacts.size(), 1U);
  EXPECT_NEAR(result.keys.contacts[0].start, 10 / rate, 1e-9);
  EXPECT_NEAR(result.keys.contacts[0].end, 50 / rate, 1e-9);
}

TEST(Blend, FeetSlideLessWithTheWarpAndLeastWhenPinned) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<BlendInput> inputs = {input_of(slow, WeightCurve::constant(0.5)),
                                          input_of(quick, WeightCurve::constant(0.5))};
  const double warped = slide(blended(inputs, keytimes_of(inputs)).clip);
  const double pinned = slide(blended(inputs, keytimes_of(inputs), {.align = Align::stance}).clip);
  // Clock time: the feet of one motion stand while the other's swing.
  const double both = std::min(slow.clip.duration(), quick.clip.duration());
  Correspondence clock;
  clock.names = {"begin", "end"};
  clock.times = {{0, both}, {0, both}};
  const double unwarped = slide(blended(inputs, clock).clip);
  std::printf("slide: warped %.1f mm/s, pinned %.1f mm/s, by the clock %.1f mm/s; alone %.1f\n",
              1e3 * warped, 1e3 * pinned, 1e3 * unwarped, 1e3 * slide(slow.clip));
  EXPECT_LT(2 * warped, unwarped);
  EXPECT_LT(pinned, warped);
}

TEST(Blend, ChangingWeightsBeginAndEndOnTheOriginals) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  std::vector<BlendInput> inputs = {input_of(slow, {}), input_of(quick, {})};
  const Correspondence moments = keytimes_of(
      {input_of(slow, WeightCurve::constant(1)), input_of(quick, WeightCurve::constant(0))});
  const double last = moments.moments() - 1;
  inputs[0].weight = {{0, last}, {1, 0}};
  inputs[1].weight = {{0, last}, {0, 1}};
  // The rate is such that the last frame is the last moment.
  const auto time = BlendTime::create(
      {TimeMap(moments.times[0], Warp::pchip), TimeMap(moments.times[1], Warp::pchip)},
      {inputs[0].weight, inputs[1].weight}, 0);
  ASSERT_TRUE(time.ok());
  const double rate = std::round(60 * time->duration()) / time->duration();
  const Blended result = blended(inputs, moments, {.rate = rate});
  // Orientations but for the heading: heights and shapes of the poses.
  const auto shape = [](const Clip& clip, int frame, std::size_t joint) {
    const int carrier = carrying_joint(find_roles(clip.skeleton));
    const Transform place = ground_frame(clip, carrier, frame).to_world().inverse();
    return Vec3(place * clip.frame_positions(frame)[joint].cast<double>());
  };
  const int end = result.clip.frame_count() - 1;
  for (std::size_t j = 0; j < result.clip.skeleton.names.size(); ++j) {
    EXPECT_LT((shape(result.clip, 0, j) - shape(slow.clip, 0, j)).norm(), 1e-5) << j;
    EXPECT_LT(
        (shape(result.clip, end, j) - shape(quick.clip, quick.clip.frame_count() - 1, j)).norm(),
        2e-3)
        << j;
  }
  EXPECT_NEAR(result.times[0][0], 0, 1e-9);
  EXPECT_NEAR(result.times[1].back(), quick.clip.duration(), 1e-3);
}

TEST(Blend, TurnsBlend) {
  samples::WalkOptions options = slow_walk();
  options.turn = 0.4;
  const KeyedWalk left = keyed_walk(options);
  options.turn = -0.4;
  const KeyedWalk right = keyed_walk(options);
  options.turn = 0;
  const KeyedWalk straight = keyed_walk(options);
  const int carrier = carrying_joint(find_roles(straight.clip.skeleton));
  const auto turned = [&](const Clip& clip) {
    double sum = 0;
    for (int f = 1; f < clip.frame_count(); ++f) {
      sum += wrapped(ground_frame(clip, carrier, f).heading -
                     ground_frame(clip, carrier, f - 1).heading);
    }
    return sum;
  };
  const auto half = WeightCurve::constant(0.5);
  const std::vector<BlendInput> both = {input_of(left, half), input_of(right, half)};
  const Blended between = blended(both, keytimes_of(both));
  EXPECT_NEAR(turned(between.clip), 0.5 * (turned(left.clip) + turned(right.clip)), 0.02);
  const std::vector<BlendInput> less = {input_of(left, half), input_of(straight, half)};
  const Blended gentle = blended(less, keytimes_of(less));
  EXPECT_NEAR(turned(gentle.clip), 0.5 * (turned(left.clip) + turned(straight.clip)), 0.02);
  // In the world, two motions that turn apart would be summed to one that stands still and shrinks.
  const auto travelled = [&](const Clip& clip) {
    double way = 0;
    for (int f = 1; f < clip.frame_count(); ++f) {
      const GroundFrame a = ground_frame(clip, carrier, f - 1), b = ground_frame(clip, carrier, f);
      way += std::hypot(b.x - a.x, b.z - a.z);
    }
    return way;
  };
  EXPECT_NEAR(travelled(between.clip), travelled(left.clip), 0.03 * travelled(left.clip));
}

TEST(Blend, AModifierMaySumToSomethingElse) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  const std::vector<BlendInput> inputs = {input_of(walk, WeightCurve::constant(1)),
                                          input_of(walk, WeightCurve::constant(0.5))};
  const RoleMap roles = find_roles(walk.clip.skeleton);
  const auto refused = blend_clips(inputs, roles, ends_of(inputs), {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, "blend-sum");
  EXPECT_NE(refused.error().hint.find("--modifier"), std::string::npos);
  const auto taken = blend_clips(inputs, roles, ends_of(inputs), {.any_sum = true});
  ASSERT_TRUE(taken.ok());
  EXPECT_EQ(taken->clip.frame_count(), walk.clip.frame_count());
}

TEST(Blend, TheSpreadIsMeasured) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  KeyedWalk twisted = walk;
  const int arm = walk.clip.skeleton.find("LeftHand");
  for (int f = 0; f < twisted.clip.frame_count(); ++f) {
    Quatf& q = twisted.clip.frame_orientations(f)[static_cast<std::size_t>(arm)];
    q = (q.cast<double>() * from_rotation_vector(Vec3(2.5, 0, 0))).cast<float>();
  }
  const std::vector<BlendInput> inputs = {input_of(walk, WeightCurve::constant(0.5)),
                                          input_of(twisted, WeightCurve::constant(0.5))};
  const Blended result = blended(inputs, ends_of(inputs));
  EXPECT_NEAR(result.widest_spread, 2.5, 1e-3);
  EXPECT_EQ(result.clip.skeleton.names[static_cast<std::size_t>(result.spread_joint)], "LeftHand");
}

TEST(Blend, ManyThreadsGiveTheSameBytes) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<BlendInput> inputs = {input_of(slow, WeightCurve::constant(0.5)),
                                          input_of(quick, WeightCurve::constant(0.5))};
  const Blended one = blended(inputs, keytimes_of(inputs), {.jobs = 1});
  const Blended four = blended(inputs, keytimes_of(inputs), {.jobs = 4});
  EXPECT_EQ(farthest(one.clip, four.clip), 0);
}

TEST(Blend, RefusesWhatDoesNotBelongTogether) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  KeyedWalk other = walk;
  other.clip.skeleton.names[3] = "Somewhere";
  const auto code = [&](const std::vector<BlendInput>& inputs, const BlendOptions& options = {}) {
    const auto result = blend_clips(inputs, find_roles(walk.clip.skeleton),
                                    ends_of({input_of(walk, WeightCurve::constant(1)),
                                             input_of(walk, WeightCurve::constant(1))}),
                                    options);
    return result.ok() ? "" : result.error().code;
  };
  const auto half = WeightCurve::constant(0.5);
  EXPECT_EQ(code({input_of(walk, half), input_of(walk, half)}), "");
  EXPECT_EQ(code({input_of(walk, half), input_of(other, half)}), "blend-skeleton");
  EXPECT_EQ(code({}), "blend-empty");
  EXPECT_EQ(code({input_of(walk, WeightCurve::constant(1))}), "blend-keys");
  EXPECT_EQ(code({input_of(walk, half), input_of(walk, half)}, {.rate = -1}), "clip-rate");
  EXPECT_EQ(code({input_of(walk, half), input_of(walk, half)}, {.rate = 1e9}), "clip-rate");
  KeyedWalk empty = walk;
  empty.clip.resize(0);
  empty.keys = {};
  EXPECT_EQ(code({input_of(walk, half), input_of(empty, half)}), "blend-empty");
}

}  // namespace
}  // namespace krok::blend
