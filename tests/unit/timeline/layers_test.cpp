// If these fail, a layer moves what it should leave alone, or too much or too little of what it
// should move.

#include <gtest/gtest.h>

#include "math/quaternion.h"
#include "timeline/layer_player.h"
#include "unit/timeline/mixed_walks.h"

namespace krok::timeline {
namespace {

class Layers : public testing::Test {
 protected:
  Layers() : walk_(keyed_walk(slow_walk())), wave_(walk_.clip) {
    wave_.resize(90);
    std::vector<Transform> local(joints()), world(joints());
    for (int f = 0; f < 90; ++f) {
      for (std::size_t j = 0; j < joints(); ++j) {
        local[j] = walk_.clip.skeleton.reference_local(static_cast<int>(j));
        const double turn = 0.02 * f * (j == arm() ? 1.0 : 0.2);
        local[j].orientation = axis_rotation(Axis::z, turn) * local[j].orientation;
      }
      local_to_world(walk_.clip.skeleton.parents, local, world);
      wave_.set_pose(f, world);
    }
  }

  std::size_t joints() const { return walk_.clip.skeleton.names.size(); }
  std::size_t joint(const char* name) const {
    const int found = walk_.clip.skeleton.find(name);
    EXPECT_GE(found, 0) << name;
    return static_cast<std::size_t>(found);
  }
  std::size_t arm() const { return joint("LeftArm"); }

  // A walk with a layer of the wave on it, from 1 s on.
  Timeline waving(LayerMode mode = LayerMode::override) const {
    Timeline timeline{0, {played(0)}, {Layer()}};
    timeline.layers[0].mode = mode;
    timeline.layers[0].mask = {below("LeftShoulder")};
    LayerItem item;
    item.name = "wave";
    item.play.source = 1;
    item.at = seconds(1);
    timeline.layers[0].items = {item};
    return timeline;
  }
  static MaskRule below(const std::string& name, double weight = 1, int soft = 0) {
    MaskRule rule;
    rule.below = name;
    rule.weight = weight;
    rule.soft = soft;
    return rule;
  }
  std::vector<Source> sources() const { return {source_of(walk_), {"wave", &wave_, nullptr, {}}}; }
  int frame(double time) const { return static_cast<int>(std::lround(time * walk_.clip.rate)); }
  double differ(const Clip& a, int f, const Clip& b, int g, std::size_t j) const {
    return angle_between(local_of(a, f)[j].orientation, local_of(b, g)[j].orientation);
  }

  KeyedWalk walk_;
  Clip wave_;
};

TEST_F(Layers, LeaveJointsOutsideTheMaskBitForBit) {
  const auto within = subtree(walk_.clip.skeleton, static_cast<int>(joint("LeftShoulder")));
  for (const auto mode : {LayerMode::override, LayerMode::additive, LayerMode::modifier}) {
    const Mixed result = mixed(waving(mode), sources());
    ASSERT_EQ(result.clip.frame_count(), walk_.clip.frame_count());
    int moved = 0;
    for (int f = 0; f < result.clip.frame_count(); ++f) {
      for (std::size_t j = 0; j < joints(); ++j) {
        const bool same = result.clip.frame_positions(f)[j] == walk_.clip.frame_positions(f)[j] &&
                          result.clip.frame_orientations(f)[j].coeffs() ==
                              walk_.clip.frame_orientations(f)[j].coeffs();
        ASSERT_TRUE(same || within[j]) << f << " " << walk_.clip.skeleton.names[j];
        moved += same ? 0 : 1;
      }
      // Before and after it nothing at all.
      const bool seen = f >= frame(1) && f <= frame(1) + 89;
      EXPECT_TRUE(seen || same_frame(result.clip, f, walk_.clip, f)) << f;
    }
    EXPECT_GT(moved, 80);
  }
}

TEST_F(Layers, OverrideIsTheLayersOwnPose) {
  const Mixed result = mixed(waving(), sources());
  for (const int k : {0, 30, 89}) {
    for (const char* name : {"LeftShoulder", "LeftArm", "LeftForeArm"}) {
      EXPECT_LT(differ(result.clip, frame(1) + k, wave_, k, joint(name)), 1e-5) << k << name;
    }
  }
}

TEST_F(Layers, WeightsAndFades) {
  Timeline timeline = waving();
  LayerItem& item = timeline.layers[0].items[0];
  item.fade_in = {0.5, *parse_easing("sine-in-out")};
  item.fade_out = {0.25, *parse_easing("linear")};
  item.weight = {{0, 0.5, 1}, {1, 1, 0.5}};
  const Mixed result = mixed(timeline, sources());
  const double lasts = wave_.duration();
  for (int k = 0; k < 90; ++k) {
    const double t = k / wave_.rate;
    const double in = t >= 0.5 ? 1 : 0.5 - 0.5 * std::cos(kPi * t / 0.5);
    const double out = lasts - t >= 0.25 ? 1 : (lasts - t) / 0.25;
    const double curve = t <= 0.5 ? 1 : t >= 1 ? 0.5 : 1 - (t - 0.5);
    const double gap = differ(walk_.clip, frame(1) + k, wave_, k, arm());
    EXPECT_NEAR(differ(result.clip, frame(1) + k, walk_.clip, frame(1) + k, arm()),
                gap * in * out * curve, 1e-5)
        << k;
  }
}

TEST_F(Layers, SoftEdgesRise) {
  const std::vector<MaskRule> rules = {below("LeftShoulder", 0.8, 2)};
  const auto weights = mask_weights(walk_.clip.skeleton, rules);
  ASSERT_TRUE(weights.ok());
  EXPECT_DOUBLE_EQ((*weights)[joint("LeftShoulder")], 0.8 / 3);
  EXPECT_DOUBLE_EQ((*weights)[joint("LeftArm")], 0.8 * 2 / 3);
  EXPECT_DOUBLE_EQ((*weights)[joint("LeftForeArm")], 0.8);
  EXPECT_DOUBLE_EQ((*weights)[joint("LeftHand")], 0.8);
  EXPECT_EQ((*weights)[joint("Hips")], 0);
  // And what is moved goes by them.
  Timeline timeline = waving();
  timeline.layers[0].mask = rules;
  const Mixed result = mixed(timeline, sources());
  for (const char* name : {"LeftShoulder", "LeftArm", "LeftForeArm"}) {
    const std::size_t j = joint(name);
    EXPECT_NEAR(differ(result.clip, frame(1) + 40, walk_.clip, frame(1) + 40, j),
                (*weights)[j] * differ(walk_.clip, frame(1) + 40, wave_, 40, j), 1e-5)
        << name;
  }
}

TEST_F(Layers, LaterRulesCountOverEarlierOnes) {
  MaskRule hand;
  hand.joints = "Left*Hand";
  hand.weight = 0.25;
  const auto weights =
      mask_weights(walk_.clip.skeleton,
                   std::vector<MaskRule>{below("LeftShoulder"), below("LeftForeArm", 0), hand});
  ASSERT_TRUE(weights.ok());
  EXPECT_EQ((*weights)[joint("LeftArm")], 1);
  EXPECT_EQ((*weights)[joint("LeftForeArm")], 0);
  EXPECT_EQ((*weights)[joint("LeftHand")], 0.25);
  // No rule: all of it.
  const auto all = mask_weights(walk_.clip.skeleton, {});
  ASSERT_TRUE(all.ok());
  for (const double weight : *all) EXPECT_EQ(weight, 1);
}

TEST_F(Layers, AdditiveOfItsOwnReferenceChangesNothing) {
  Timeline timeline = waving(LayerMode::additive);
  timeline.layers[0].mask.clear();
  LayerItem& item = timeline.layers[0].items[0];
  item.play.from = item.play.to = seconds(0.5);
  item.play.until = seconds(2.5);
  const Mixed result = mixed(timeline, sources());
  EXPECT_LT(farthest(result.clip, walk_.clip), 1e-6);
  timeline.layers[0].reference = seconds(0.5);
  EXPECT_LT(farthest(mixed(timeline, sources()).clip, walk_.clip), 1e-6);
  // Of another reference it changes something.
  timeline.layers[0].reference = seconds(0);
  EXPECT_GT(farthest(mixed(timeline, sources()).clip, walk_.clip), 0.05);
}

TEST_F(Layers, ModifiersTakeAnyWeight) {
  Timeline timeline = waving(LayerMode::modifier);
  timeline.layers[0].reference_pose = true;
  const int k = 20;  // the arm is turned by 0.4 from the reference pose, about its parent's Z
  for (const double weight : {-1.0, 0.0, 0.5, 1.0, 2.5}) {
    timeline.layers[0].items[0].weight = blend::WeightCurve::constant(weight);
    const Mixed result = mixed(timeline, sources());
    const Quat turned = local_of(result.clip, frame(1) + k)[arm()].orientation *
                        local_of(walk_.clip, frame(1) + k)[arm()].orientation.conjugate();
    EXPECT_LT((rotation_vector(turned) - Vec3(0, 0, 0.4 * weight)).norm(), 1e-5) << weight;
  }
  for (const auto mode : {LayerMode::override, LayerMode::additive}) {
    timeline.layers[0].mode = mode;
    const auto refused = try_mix(timeline, sources());
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, "timeline-weight");
  }
}

// The pelvis of a walk turns; a trunk that is kept in the model's space does not.
TEST_F(Layers, InModelSpaceJointsKeepTheirDirection) {
  Timeline timeline = waving();
  timeline.layers[0].mask = {below("Spine")};
  timeline.layers[0].items[0].play.from = timeline.layers[0].items[0].play.to = seconds(0);
  timeline.layers[0].items[0].play.until = seconds(2.5);
  const int carrier = carrying_joint(find_roles(walk_.clip.skeleton));
  const auto sways = [&](Space space) {
    timeline.layers[0].space = space;
    const Mixed result = mixed(timeline, sources());
    double most = 0;
    for (int f = frame(1); f <= frame(2.4); ++f) {
      const GroundFrame place = ground_frame(result.clip, carrier, f);
      const Quat head = axis_rotation(Axis::y, -place.heading) *
                        result.clip.frame_orientations(f)[joint("Head")].cast<double>();
      const GroundFrame own = ground_frame(wave_, carrier, 0);
      const Quat wanted = axis_rotation(Axis::y, -own.heading) *
                          wave_.frame_orientations(0)[joint("Head")].cast<double>();
      most = std::max(most, angle_between(head, wanted));
    }
    return most;
  };
  EXPECT_LT(sways(Space::model), 1e-5);
  EXPECT_GT(sways(Space::parent), 0.02);
}

TEST_F(Layers, SeveralGoOneOnTopOfTheOther) {
  Timeline timeline = waving();
  timeline.layers.push_back(waving(LayerMode::modifier).layers[0]);
  timeline.layers[1].reference_pose = true;
  timeline.layers[1].items[0].weight = blend::WeightCurve::constant(-1);
  const Mixed result = mixed(timeline, sources());
  // The wave, and what it differs by from the reference pose taken off again.
  for (const int k : {10, 50}) {
    EXPECT_LT(
        angle_between(local_of(result.clip, frame(1) + k)[arm()].orientation,
                      walk_.clip.skeleton.reference_local(static_cast<int>(arm())).orientation),
        1e-5);
  }
}

TEST_F(Layers, ContactsOfLegsTheyMoveAreDropped) {
  Timeline timeline = waving();
  const std::size_t all = mixed(timeline, sources()).keys.contacts.size();
  timeline.layers[0].mask = {below("LeftUpLeg")};
  const Mixed result = mixed(timeline, sources());
  const auto leg = subtree(walk_.clip.skeleton, static_cast<int>(joint("LeftUpLeg")));
  const double end = 1 + wave_.duration();
  std::size_t right = 0;
  for (const Contact& contact : result.keys.contacts) {
    if (!leg[static_cast<std::size_t>(contact.joint)]) {
      ++right;
      continue;
    }
    EXPECT_TRUE(contact.end <= 1 + 1e-9 || contact.start >= end - 1e-9);
  }
  EXPECT_GT(right, 0u);
  EXPECT_LT(result.keys.contacts.size(), all + 3);
}

TEST_F(Layers, WhatCannotBePlayedIsRefusedWithItsPlace) {
  struct RefusedLayer {
    const char* code;
    std::function<void(Layer&)> change;
  };
  const auto item = [](Layer& l) -> LayerItem& { return l.items[0]; };
  const RefusedLayer cases[] = {
      {"timeline-mask", [&](Layer& l) { l.mask = {below("Tail")}; }},
      {"timeline-mask", [&](Layer& l) { l.mask = {below("LeftArm", 1.5)}; }},
      {"timeline-mask", [&](Layer& l) { l.mask = {below("LeftArm", std::nan(""))}; }},
      {"timeline-mask", [&](Layer& l) { l.mask = {below("LeftArm", 1, -1)}; }},
      {"timeline-mask", [&](Layer& l) { l.mask = {MaskRule()}; }},
      {"timeline-source", [&](Layer& l) { item(l).play.source = 5; }},
      {"timeline-time", [&](Layer& l) { item(l).at = seconds(1000); }},
      {"timeline-time", [&](Layer& l) { item(l).at = seconds(-1); }},
      {"timeline-time", [&](Layer& l) { item(l).at = seconds(std::nan("")); }},
      {"timeline-time", [&](Layer& l) { item(l).play.until = seconds(0.5); }},
      {"timeline-time", [&](Layer& l) { item(l).play.until = seconds(100); }},
      {"timeline-time", [&](Layer& l) { item(l).fade_in.duration = 5; }},
      {"timeline-time", [&](Layer& l) { item(l).fade_out.duration = -1; }},
      {"timeline-time",
       [&](Layer& l) {
         l.mode = LayerMode::additive;
         l.reference = seconds(99);
       }},
      {"timeline-weight",
       [&](Layer& l) {
         item(l).weight = {{}, {}};
       }},
      {"timeline-weight",
       [&](Layer& l) {
         item(l).weight = {{1, 1}, {0, 1}};
       }},
      {"timeline-weight",
       [&](Layer& l) {
         item(l).weight = {{0}, {std::nan("")}};
       }},
      {"timeline-time",
       [&](Layer& l) {
         item(l).marks = {{"late", seconds(50), false}};
       }},
  };
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    Timeline timeline = waving();
    timeline.layers[0].where.line = 5;
    timeline.layers[0].items[0].where.line = 6;
    cases[i].change(timeline.layers[0]);
    for (MaskRule& rule : timeline.layers[0].mask) rule.where.line = 7;
    const auto result = try_mix(timeline, sources());
    ASSERT_FALSE(result.ok()) << i;
    EXPECT_EQ(result.error().code, cases[i].code) << i << " " << result.error().message;
    EXPECT_GE(result.error().where.line, 5) << i;
  }
}

TEST(Events, ComeAtTheRightTimes) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Source source = source_of(walk);
  Timeline timeline{0, {played(0), changed(0, ChangeKind::smooth, 0.5)}, {Layer()}};
  timeline.base[0].play.from = seconds(0.5);
  timeline.base[0].play.to = seconds(1.5);
  timeline.base[0].play.speed = 2;
  timeline.base[0].play.rounds = 3;
  timeline.base[0].name = "first";
  timeline.base[0].marks = {{"step", seconds(1.0), true}, {"half", seconds(0.75), false}};
  timeline.base[1].name = "second";
  timeline.base[1].play.to = seconds(1);
  timeline.base[1].marks = {{"never", seconds(2), true}};
  LayerItem item;
  item.name = "top";
  item.at = seconds(0.25);
  item.play.to = seconds(0.5);
  timeline.layers[0].items = {item};
  const Mixed result = mixed(timeline, {source});
  using Kind = Event::Kind;
  const std::vector<std::tuple<double, Kind, std::string, std::string, int>> expected = {
      {0, Kind::begin, "first", "", 0},       {0.25, Kind::mark, "first", "step", 0},
      {0.25, Kind::begin, "top", "", 0},      {0.5, Kind::loop, "first", "", 1},
      {0.75, Kind::mark, "first", "step", 1}, {0.75, Kind::mark, "first", "half", 0},
      {0.75, Kind::end, "top", "", 0},        {1, Kind::loop, "first", "", 2},
      {1.25, Kind::mark, "first", "step", 2}, {1.5, Kind::end, "first", "", 0},
      {2, Kind::begin, "second", "", 0},      {3, Kind::end, "second", "", 0}};
  ASSERT_EQ(result.events.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto& [time, kind, name, mark, round] = expected[i];
    EXPECT_NEAR(result.events[i].time, time, 1e-9) << i;
    EXPECT_EQ(result.events[i].kind, kind) << i;
    EXPECT_EQ(result.events[i].item, name) << i;
    EXPECT_EQ(result.events[i].name, mark) << i;
    EXPECT_EQ(result.events[i].round, round) << i;
    EXPECT_EQ(result.events[i].layer, name == "top" ? 0 : -1) << i;
  }
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_EQ(result.warnings[0].code, "timeline-mark");
}

TEST(Events, ARoundThatWouldBeginAtTheEndIsNone) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Timeline timeline{0, {played(0)}, {Layer()}};
  timeline.base[0].play.rounds = 2;
  timeline.layers[0].items.resize(1);
  timeline.layers[0].items[0].play.rounds = 0;
  const Mixed result = mixed(timeline, {source_of(walk)});
  ASSERT_EQ(result.items.size(), 2u);
  for (const ItemFacts& item : result.items) {
    EXPECT_EQ(item.rounds, 2);
    EXPECT_NEAR(item.end, 2 * walk.clip.duration(), 1e-9);
  }
  EXPECT_EQ(std::ranges::count(result.events, Event::Kind::loop, &Event::kind), 2);
}

TEST(Events, TooManyAreRefused) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Timeline timeline{0, {played(0)}, {}};
  timeline.base[0].play.to = seconds(0.001);
  timeline.base[0].play.rounds = 0;
  timeline.base[0].play.until = seconds(90);
  const Source source = {"walk", &walk.clip, nullptr, {}};
  EXPECT_TRUE(try_mix(timeline, {source}).ok());
  timeline.base[0].marks.resize(1000, {"m", seconds(0), true});
  const auto many = try_mix(timeline, {source});
  ASSERT_FALSE(many.ok());
  EXPECT_EQ(many.error().code, "timeline-limit");

  // Nor layers without end.
  Timeline layered{0, {played(0)}, {Layer(), Layer(), Layer()}};
  for (Layer& layer : layered.layers) layer.items.resize(8'000);
  const auto deep = try_mix(layered, {source});
  ASSERT_FALSE(deep.ok());
  EXPECT_EQ(deep.error().code, "timeline-limit");
}

}  // namespace
}  // namespace krok::timeline
