// If these fail, the figure jumps, slides or stumbles where one motion goes over into the next.

#include <gtest/gtest.h>

#include "math/quaternion.h"
#include "unit/timeline/mixed_walks.h"

namespace krok::timeline {
namespace {

constexpr ChangeKind kGentle[] = {ChangeKind::crossfade, ChangeKind::smooth, ChangeKind::inertial};

// The largest way of a joint from frame to frame, metres, and the largest change of a joint's turn
// in its parent from one step to the next, radians: jumps of position and of velocity.
struct Jumps {
  double way = 0, turn = 0;
};

Jumps jumps(const Clip& clip, int from, int to) {
  Jumps most;
  const std::size_t joints = clip.skeleton.names.size();
  std::vector<Vec3> before(joints, Vec3::Zero());
  for (int f = std::max(from, 1); f <= std::min(to, clip.frame_count() - 1); ++f) {
    const auto a = local_of(clip, f - 1), b = local_of(clip, f);
    for (std::size_t j = 0; j < joints; ++j) {
      most.way = std::max<double>(
          most.way, (clip.frame_positions(f)[j] - clip.frame_positions(f - 1)[j]).norm());
      const Vec3 turn = rotation_vector(b[j].orientation * a[j].orientation.conjugate());
      if (f > std::max(from, 1)) most.turn = std::max(most.turn, (turn - before[j]).norm());
      before[j] = turn;
    }
  }
  return most;
}

Jumps jumps(const Clip& clip) {
  return jumps(clip, 0, clip.frame_count() - 1);
}

// From one walk into another one at another moment of a step.
Timeline walk_into_walk(ChangeKind kind, double duration) {
  Timeline timeline{0, {played(0), changed(1, kind, duration)}, {}};
  timeline.base[0].play.to = seconds(2.1);
  timeline.base[1].play.from = seconds(0.9);
  timeline.base[1].change.sync = Sync::clock;
  return timeline;
}

TEST(Changes, GentleOnesHaveNoJumpsThatTheMotionsHaveNot) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  const Jumps a = jumps(slow.clip), b = jumps(quick.clip);
  const double way = std::max(a.way, b.way), turn = std::max(a.turn, b.turn);
  for (const Align align : {Align::root, Align::stance}) {
    for (const ChangeKind kind : kGentle) {
      Timeline timeline = walk_into_walk(kind, 0.3);
      timeline.base[1].change.align = align;
      const Mixed result = mixed(timeline, sources);
      const Jumps found = jumps(result.clip);
      std::printf("%-10s %s: way %.1f of %.1f mm, turn %.2f of %.2f degrees a frame\n",
                  std::string(change_name(kind)).c_str(), align == Align::root ? "root" : "feet",
                  1e3 * found.way, 1e3 * way, found.turn / kRadiansPerDegree,
                  turn / kRadiansPerDegree);
      EXPECT_LT(found.way, 1.25 * way) << change_name(kind);
      EXPECT_LT(found.turn, 1.25 * turn) << change_name(kind);
    }
  }
  // A cut has: what is measured is seen.
  const Jumps cut = jumps(mixed(walk_into_walk(ChangeKind::cut, 0), sources).clip);
  EXPECT_GT(cut.way, 2 * way);
  EXPECT_GT(cut.turn, 2 * turn);
}

TEST(Changes, PopsAreTold) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  const Mixed cut = mixed(walk_into_walk(ChangeKind::cut, 0), sources);
  ASSERT_EQ(cut.changes.size(), 1u);
  EXPECT_TRUE(cut.changes[0].pops());
  EXPECT_NEAR(cut.changes[0].begin, 2.1, 1e-9);
  EXPECT_EQ(cut.changes[0].fastest_frame, static_cast<int>(std::lround(2.1 * slow.clip.rate)));
  EXPECT_GT(cut.changes[0].angle, 0.2);
  EXPECT_GT(cut.changes[0].paces[feet_speed].most, 3 * cut.changes[0].paces[feet_speed].usual);
  for (const ChangeKind kind : kGentle) {
    Timeline timeline = walk_into_walk(kind, 0.3);
    timeline.base[1].change.sync = Sync::automatic;
    const Mixed gentle = mixed(timeline, sources);
    EXPECT_FALSE(gentle.changes[0].pops()) << change_name(kind);
    EXPECT_NEAR(gentle.changes[0].angle, cut.changes[0].angle,
                kind == ChangeKind::crossfade ? 1 : 1e-6);
  }
}

// The angles of a walk that goes on half a metre aside, or faces about, are those of the walk.
TEST(Changes, PopsOfHipsAndFeetAreTold) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Timeline timeline{0, {played(0), changed(0, ChangeKind::cut, 0)}, {}};
  timeline.base[0].play.to = seconds(1.5);
  timeline.base[1].play.from = seconds(1.5);
  const Mixed goes_on = mixed(timeline, {source_of(walk)});
  EXPECT_FALSE(goes_on.changes[0].pops());
  const int carrier = carrying_joint(find_roles(walk.clip.skeleton));
  GroundFrame place = ground_frame(walk.clip, carrier, static_cast<int>(1.5 * walk.clip.rate));
  place.x += 0.5;
  timeline.base[1].place = place;
  const Mixed aside = mixed(timeline, {source_of(walk)});
  const ChangeFacts& change = aside.changes[0];
  EXPECT_FALSE(change.turns_too_fast());
  EXPECT_TRUE(change.pops());
  EXPECT_NEAR(change.paces[hips_speed].most, 0.5 * walk.clip.rate, 1);
  EXPECT_EQ(change.paces[hips_speed].joint, carrier);
  EXPECT_NEAR(change.paces[hips_speed].frame, 1.5 * walk.clip.rate, 1.1);
}

// By the clock one motion's foot takes over from the other's at once.
TEST(Changes, FeetOutOfStepJerkTheHips) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  const auto jerk = [&](Sync sync) {
    Timeline timeline = walk_into_walk(ChangeKind::crossfade, 0.3);
    timeline.base[1].change.sync = sync;
    const ChangeFacts change = mixed(timeline, sources).changes[0];
    EXPECT_FALSE(change.turns_too_fast());
    EXPECT_EQ(change.pops(), sync == Sync::clock);
    return change.paces[hips_acceleration].most / change.paces[hips_acceleration].usual;
  };
  EXPECT_GT(jerk(Sync::clock), 4);
  EXPECT_LT(jerk(Sync::automatic), 2);
}

TEST(Smooth, PutsItsDurationInBetween) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  const Mixed cut = mixed(walk_into_walk(ChangeKind::cut, 0), sources);
  const Mixed smooth = mixed(walk_into_walk(ChangeKind::smooth, 0.5), sources);
  const int added = static_cast<int>(std::lround(0.5 * slow.clip.rate));
  EXPECT_EQ(smooth.clip.frame_count(), cut.clip.frame_count() + added);
  const int join = static_cast<int>(std::lround(2.1 * slow.clip.rate));
  for (int f = 0; f < join; ++f) EXPECT_TRUE(same_frame(smooth.clip, f, slow.clip, f)) << f;
  // The last pose of the one, the first of the other.
  const auto differ = [&](const Clip& clip, int f, const Clip& other, int g) {
    const auto a = local_of(clip, f), b = local_of(other, g);
    double most = 0;
    for (std::size_t j = 1; j < a.size(); ++j) {
      most = std::max(most, angle_between(a[j].orientation, b[j].orientation));
    }
    return most;
  };
  EXPECT_LT(differ(smooth.clip, join, slow.clip, join), 1e-5);
  EXPECT_LT(differ(smooth.clip, join + added, quick.clip,
                   static_cast<int>(std::lround(0.9 * quick.clip.rate))),
            1e-5);
  EXPECT_NEAR(smooth.items[1].start, 2.6, 1e-9);
}

// STEPS: x(t) = A t^5 + B t^4 + C t^3 + a0 t^2 / 2 + v0 t + x0.
double quintic(double x0, double v0, double a0, double T, double t) {
  if (t >= T) return 0;
  const double A = -(a0 * T * T + 6 * v0 * T + 12 * x0) / (2 * std::pow(T, 5));
  const double B = (3 * a0 * T * T + 16 * v0 * T + 30 * x0) / (2 * std::pow(T, 4));
  const double C = -(3 * a0 * T * T + 12 * v0 * T + 20 * x0) / (2 * std::pow(T, 3));
  return A * std::pow(t, 5) + B * std::pow(t, 4) + C * std::pow(t, 3) + a0 * t * t / 2 + v0 * t +
         x0;
}

TEST(Inertial, OfOneJointIsTheClosedForm) {
  const double rate = 400, T = 0.4;
  const auto first = [](double t) { return 0.2 + 0.9 * t - 0.5 * t * t; };
  const auto second = [](double t) { return -0.3 - 0.4 * t + 0.8 * t * t; };
  const Clip a = turning(1, rate, first), b = turning(1.5, rate, second);
  const std::vector<Source> sources = {{"a", &a, nullptr, {}}, {"b", &b, nullptr, {}}};
  Timeline timeline{0, {played(0), changed(1, ChangeKind::inertial, T)}, {}};
  timeline.base[1].change.guard = false;
  const Mixed result = mixed(timeline, sources);
  const double x0 = first(1) - second(0), v0 = (0.9 - 1.0) - (-0.4), a0 = -1.0 - 1.6;
  ASSERT_EQ(result.clip.frame_count(), 1001);
  for (int f = 0; f <= 1000; ++f) {
    const double t = f / rate - 1;
    const double expected = t < 0 ? first(f / rate) : second(t) + quintic(x0, v0, a0, T, t);
    EXPECT_NEAR(angle_of(result.clip, f), expected, 2e-4) << f;
  }
  // Velocity and acceleration go on through the join.
  const auto at = [&](int f) { return angle_of(result.clip, f); };
  EXPECT_NEAR((at(401) - at(399)) * rate / 2, 0.9 - 1.0, 0.02);
  EXPECT_NEAR((at(401) - 2 * at(400) + at(399)) * rate * rate, -1.0, 0.6);
}

TEST(Inertial, GuardedDoesNotSwingBeyond) {
  const double rate = 100;
  // Home at ten times what is missing in the time, and braking hard the wrong way.
  const Clip a =
      turning(1, rate, [](double t) { return 0.5 - 5 * (t - 1) - 40 * (t - 1) * (t - 1); });
  const Clip b = turning(1, rate, [](double) { return 0.0; });
  const std::vector<Source> sources = {{"a", &a, nullptr, {}}, {"b", &b, nullptr, {}}};
  Timeline timeline{0, {played(0), changed(1, ChangeKind::inertial, 0.6)}, {}};
  const auto least = [&](bool guard) {
    timeline.base[1].change.guard = guard;
    const Mixed result = mixed(timeline, sources);
    double angle = 1;
    for (int f = 100; f < result.clip.frame_count(); ++f) {
      angle = std::min(angle, angle_of(result.clip, f));
    }
    return angle;
  };
  EXPECT_GT(least(true), -1e-3);
  EXPECT_LT(least(false), -0.1);
}

TEST(Crossfade, GoesOverByItsEasing) {
  const Clip a = turning(0, 50, [](double) { return 0.2; });
  const Clip b = turning(0, 50, [](double) { return 1.4; });
  const std::vector<Source> sources = {{"a", &a, nullptr, {}}, {"b", &b, nullptr, {}}};
  for (const std::string& name : easing_names()) {
    Timeline timeline{50, {played(0), changed(1, ChangeKind::crossfade, 1)}, {}};
    timeline.base[0].play.until = seconds(2);
    timeline.base[1].play.until = seconds(3);
    timeline.base[1].change.easing = *parse_easing(name);
    const Mixed result = mixed(timeline, sources);
    ASSERT_EQ(result.clip.frame_count(), 151);
    for (int f = 0; f <= 150; ++f) {
      const double u = timeline.base[1].change.easing.at(f / 50.0 - 1);
      EXPECT_NEAR(angle_of(result.clip, f), 0.2 + 1.2 * u, 1e-5) << name << " " << f;
    }
  }
}

int frame_at(const Mixed& result, double time) {
  return static_cast<int>(std::lround(time * result.clip.rate));
}

TEST(Crossfade, InStepFeetAgree) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  Timeline timeline{0, {played(0), changed(1, ChangeKind::crossfade, 0.9)}, {}};
  timeline.base[0].play.to = seconds(2.6);
  timeline.base[1].play.from = seconds(0.5);  // the other leg
  const auto slides = [&](Sync sync, Align align) {
    timeline.base[1].change.sync = sync;
    timeline.base[1].change.align = align;
    const Mixed result = mixed(timeline, sources);
    EXPECT_EQ(result.changes[0].in_step, sync == Sync::keytimes);
    return blend::slide(result.clip, frame_at(result, result.changes[0].begin),
                        frame_at(result, result.changes[0].end));
  };
  const double clock = slides(Sync::clock, Align::root);
  const double step = slides(Sync::keytimes, Align::root);
  const double feet = slides(Sync::keytimes, Align::stance);
  std::printf("slide: by the clock %.0f, in step %.0f, on the feet %.0f mm/s\n", 1e3 * clock,
              1e3 * step, 1e3 * feet);
  EXPECT_LT(2 * step, clock);
  EXPECT_LT(feet, step);

  // Steps follow one another as in a walk: none is left out, none comes twice.
  timeline.base[1].change.sync = Sync::automatic;
  const Mixed result = mixed(timeline, sources);
  EXPECT_TRUE(result.changes[0].in_step);
  EXPECT_GT(result.items[1].skipped, 0);
  std::vector<std::string> order;
  for (const Keytime& key : slow.keys.keytimes) order.push_back(key.name);
  ASSERT_GT(result.keys.keytimes.size(), 10u);
  for (std::size_t k = 1; k < result.keys.keytimes.size(); ++k) {
    // What may follow a name is what follows it in the walk.
    bool follows = false;
    for (std::size_t i = 1; i < order.size(); ++i) {
      follows = follows || (order[i - 1] == result.keys.keytimes[k - 1].name &&
                            order[i] == result.keys.keytimes[k].name);
    }
    EXPECT_TRUE(follows) << k << " " << result.keys.keytimes[k].name;
    EXPECT_GT(result.keys.keytimes[k].time - result.keys.keytimes[k - 1].time, 0.03) << k;
  }
}

// The keytimes of a run: each foot leaves before the other one strikes.
KeyedWalk with_keys_of_a_run(KeyedWalk walk) {
  for (Keytime& key : walk.keys.keytimes) {
    if (key.name.ends_with("_off")) key.time -= 0.25;
  }
  std::erase_if(walk.keys.keytimes, [](const Keytime& key) { return key.time < 0; });
  std::ranges::sort(walk.keys.keytimes, {}, &Keytime::time);
  return walk;
}

// Would fail if a walk changed into a run by the clock, since their offs come in another order, or
// if a change by the clock were not told.
TEST(Crossfade, AWalkAndARunAreAlignedByTheirStrikes) {
  const KeyedWalk slow = keyed_walk(slow_walk()),
                  run = with_keys_of_a_run(keyed_walk(quick_walk()));
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(run, "run")};
  Timeline timeline{0, {played(0), changed(1, ChangeKind::crossfade, 0.9)}, {}};
  timeline.base[0].play.to = seconds(2.6);
  timeline.base[1].play.from = seconds(0.5);  // the other leg
  const auto slides = [&](Sync sync) {
    timeline.base[1].change.sync = sync;
    const Mixed result = mixed(timeline, sources);
    EXPECT_EQ(result.changes[0].in_step, sync != Sync::clock);
    EXPECT_TRUE(result.warnings.empty());
    return blend::slide(result.clip, frame_at(result, result.changes[0].begin),
                        frame_at(result, result.changes[0].end));
  };
  EXPECT_LT(2 * slides(Sync::automatic), slides(Sync::clock));

  KeyedWalk other = run;
  for (Keytime& key : other.keys.keytimes) key.name = "beat";
  timeline.base[1].change.sync = Sync::automatic;
  const Mixed result = mixed(timeline, {sources[0], source_of(other, "run")});
  EXPECT_FALSE(result.changes[0].in_step);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(result.warnings[0].code, "timeline-clock");
}

// Would fail if a walk without keytimes changed into another by the clock without a warning, or if
// a walk that ends in standing, or a clock that is asked for, gave one.
TEST(Crossfade, AWalkWithoutKeytimesIsReported) {
  const KeyedWalk slow = keyed_walk(slow_walk());
  KeyedWalk bare = keyed_walk(quick_walk());
  bare.keys.keytimes.clear();
  Timeline timeline{0, {played(0), changed(1, ChangeKind::crossfade, 0.9)}, {}};
  timeline.base[0].play.to = seconds(2.6);
  const Mixed result = mixed(timeline, {source_of(slow, "slow"), source_of(bare, "bare")});
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(result.warnings[0].code, "timeline-clock");

  KeyedWalk still = bare;
  for (int f = 1; f < still.clip.frame_count(); ++f) {
    std::ranges::copy(still.clip.frame_positions(0), still.clip.frame_positions(f).begin());
    std::ranges::copy(still.clip.frame_orientations(0), still.clip.frame_orientations(f).begin());
  }
  EXPECT_TRUE(
      mixed(timeline, {source_of(slow, "slow"), source_of(still, "still")}).warnings.empty());
  timeline.base[1].change.sync = Sync::clock;
  EXPECT_TRUE(mixed(timeline, {source_of(slow, "slow"), source_of(bare, "bare")}).warnings.empty());
}

TEST(Crossfade, BothGoAtTheirOwnSpeedAtItsEnds) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  Timeline timeline{0, {played(0), changed(1, ChangeKind::crossfade, 0.9)}, {}};
  timeline.base[0].play.to = seconds(2.6);
  timeline.base[1].marks = {{"a", seconds(1.5), true}, {"b", seconds(2), true}};
  const Mixed result = mixed(timeline, sources);
  double a = 0, b = 0;
  for (const Event& event : result.events) {
    if (event.name == "a") a = event.time;
    if (event.name == "b") b = event.time;
  }
  EXPECT_GT(a, result.changes[0].end);
  EXPECT_NEAR(b - a, 0.5, 1e-9);
  EXPECT_NEAR(result.items[1].end, a + quick.clip.duration() - 1.5, 1e-9);
}

TEST(Changes, ToAPlaceThatIsTold) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  const int carrier = carrying_joint(find_roles(walk.clip.skeleton));
  for (const ChangeKind kind : kGentle) {
    Timeline timeline{0, {played(0), changed(0, kind, 0.4)}, {}};
    timeline.base[0].play.to = seconds(2);
    timeline.base[1].place = GroundFrame{0.3, 2, 0.7};
    timeline.base[1].change.sync = Sync::clock;
    const Mixed result = mixed(timeline, {source_of(walk)});
    // When the change is over the figure is where a motion that begins at that place has it.
    const double play = kind == ChangeKind::smooth ? 0 : 0.4;
    const int f = static_cast<int>(std::lround(result.changes[0].end * walk.clip.rate));
    const int g = static_cast<int>(std::lround(play * walk.clip.rate));
    const Transform moved = timeline.base[1].place->to_world() *
                            ground_frame(walk.clip, carrier, 0).to_world().inverse();
    const auto c = static_cast<std::size_t>(carrier);
    const Vec3 expected = moved * walk.clip.frame_positions(g)[c].cast<double>();
    EXPECT_LT((result.clip.frame_positions(f)[c].cast<double>() - expected).norm(), 0.02)
        << change_name(kind);
  }
}

TEST(Changes, OnTheFeetTheStandingFootStays) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  // The moments in which the left toes stand in both.
  const auto middle_of = [](const KeyedWalk& walk, double after) {
    for (const Contact& contact : walk.keys.contacts) {
      if (contact.joint == walk.clip.skeleton.find("LeftToeBase") && contact.start > after) {
        return 0.5 * (contact.start + contact.end);
      }
    }
    return 0.0;
  };
  const auto toe = static_cast<std::size_t>(slow.clip.skeleton.find("LeftToeBase"));
  for (const ChangeKind kind : {ChangeKind::smooth, ChangeKind::inertial}) {
    double ways[2];
    for (const Align align : {Align::root, Align::stance}) {
      Timeline timeline{0, {played(0), changed(1, kind, 0.2)}, {}};
      timeline.base[0].play.to = seconds(middle_of(slow, 0.5));
      timeline.base[1].play.from = seconds(middle_of(quick, 0.3));
      timeline.base[1].change.align = align;
      const Mixed result = mixed(timeline, sources);
      EXPECT_EQ(result.changes[0].on_feet, align == Align::stance);
      const int f = static_cast<int>(result.changes[0].begin * slow.clip.rate);
      const int end = static_cast<int>(result.items[1].start * slow.clip.rate) + 6;
      Vec3f way = result.clip.frame_positions(end)[toe] - result.clip.frame_positions(f)[toe];
      way.y() = 0;
      ways[align == Align::root ? 0 : 1] = way.norm();
    }
    std::printf("%s: the standing toe moves %.1f mm by the root, %.1f mm on the feet\n",
                std::string(change_name(kind)).c_str(), 1e3 * ways[0], 1e3 * ways[1]);
    EXPECT_LT(ways[1], 0.5 * ways[0]) << change_name(kind);
  }
}

TEST(Changes, ContactsOfAChangeAreNotKept) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  for (const ChangeKind kind : kGentle) {
    const Mixed result = mixed(walk_into_walk(kind, 0.3), sources);
    for (const Contact& contact : result.keys.contacts) {
      EXPECT_TRUE(contact.end <= result.changes[0].begin + 1e-9 ||
                  contact.start >= result.changes[0].end - 1e-9);
      // And they are where the foot is.
      const int f = static_cast<int>(0.5 * (contact.start + contact.end) * slow.clip.rate);
      Vec3 off =
          result.clip.frame_positions(f)[static_cast<std::size_t>(contact.joint)].cast<double>() -
          contact.place;
      off.y() = 0;
      EXPECT_LT(off.norm(), 0.12);
    }
    EXPECT_FALSE(result.keys.contacts.empty());
  }
}

TEST(Changes, AreTheSameOnAnyNumberOfThreads) {
  const KeyedWalk slow = keyed_walk(slow_walk()), quick = keyed_walk(quick_walk());
  const std::vector<Source> sources = {source_of(slow, "slow"), source_of(quick, "quick")};
  for (const ChangeKind kind : kGentle) {
    const auto one = try_mix(walk_into_walk(kind, 0.3), sources, 1);
    const auto four = try_mix(walk_into_walk(kind, 0.3), sources, 4);
    ASSERT_TRUE(one.ok() && four.ok());
    for (int f = 0; f < one->clip.frame_count(); ++f) {
      ASSERT_TRUE(same_frame(one->clip, f, four->clip, f)) << f;
    }
  }
}

}  // namespace
}  // namespace krok::timeline
