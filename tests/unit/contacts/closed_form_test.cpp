// Feet that move after formulas. If these fail, a contact begins or ends elsewhere than the formula
// says, a foot held in the air counts as standing, or clips that hold no walk bring crashes or
// invented steps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "contacts/gait_metrics.h"
#include "contacts/sole_points.h"
#include "contacts/step_measures.h"
#include "events.h"
#include "motion/sample.h"
#include "motion/travel.h"

namespace krok {
namespace {

// A pair of legs whose hips are moved, and whose feet follow functions of time; the rest hangs on.
class Legs {
 public:
  using Path = std::function<Vec3(double)>;

  explicit Legs(double rate) {
    clip_.rate = rate;
    Skeleton& s = clip_.skeleton;
    const auto at = [](double x, double y, double z) {
      return Transform{Vec3(x, y, z), Quat::Identity()};
    };
    s.add("Hips", Skeleton::kNoParent, at(0, 0.9, 0));
    for (const double side : {1.0, -1.0}) {
      const std::string name = side > 0 ? "Left" : "Right";
      const int up = s.add(name + "UpLeg", 0, at(0.1 * side, 0.88, 0));
      const int leg = s.add(name + "Leg", up, at(0.1 * side, 0.48, 0));
      const int foot = s.add(name + "Foot", leg, at(0.1 * side, 0.07, 0));
      const int toes = s.add(name + "ToeBase", foot, at(0.1 * side, 0.02, 0.13));
      s.add(name + "Toe_end", toes, at(0.1 * side, 0.01, 0.2), true);
    }
    const int spine = s.add("Spine", 0, at(0, 1.1, 0));
    const int head = s.add("Head", spine, at(0, 1.5, 0));
    s.add("Head_end", head, at(0, 1.7, 0), true);
    for (const double side : {1.0, -1.0}) {
      const std::string name = side > 0 ? "Left" : "Right";
      const int arm = s.add(name + "Arm", spine, at(0.2 * side, 1.4, 0));
      const int fore = s.add(name + "ForeArm", arm, at(0.45 * side, 1.4, 0));
      s.add(name + "Hand", fore, at(0.7 * side, 1.4, 0));
    }
  }

  // How hips and feet are moved from where the reference pose has them.
  Clip move(double seconds, const Path& hips, const Path& left, const Path& right) {
    const int frames = static_cast<int>(std::lround(seconds * clip_.rate)) + 1;
    clip_.resize(frames);
    std::vector<Transform> pose(clip_.skeleton.names.size());
    for (int f = 0; f < frames; ++f) {
      const double t = f / clip_.rate;
      for (std::size_t j = 0; j < pose.size(); ++j) {
        const std::string& name = clip_.skeleton.names[j];
        pose[j] = clip_.skeleton.reference[j];
        const bool foot =
            name.find("Foot") != std::string::npos || name.find("Toe") != std::string::npos;
        pose[j].position += !foot ? hips(t) : name.starts_with("Left") ? left(t) : right(t);
      }
      clip_.set_pose(f, pose);
    }
    return clip_;
  }

 private:
  Clip clip_;
};

Vec3 still(double) {
  return Vec3::Zero();
}

std::vector<Contact> contacts_of(const Clip& clip, const std::string& joint) {
  const auto found = find_contacts(clip, find_roles(clip.skeleton));
  EXPECT_TRUE(found.ok()) << (found.ok() ? "" : found.error().message);
  std::vector<Contact> list;
  if (!found) return list;
  for (const Contact& contact : found->contacts) {
    if (clip.skeleton.names[static_cast<std::size_t>(contact.joint)] == joint) {
      list.push_back(contact);
    }
  }
  return list;
}

// A step after the cycloid x = S (u - sin(2 pi u) / 2 pi), y = H (1 - cos(2 pi u)), u from 0 to 1
// in the swing: velocity 0 at both ends. Cycle 1 s, swing from 0.6 s to 1 s, the other foot half a
// cycle later; the hips go evenly.
Vec3 cycloid(double t, double phase) {
  const double cycle = std::floor(t + phase), part = t + phase - cycle;
  const double u = std::clamp((part - 0.6) / 0.4, 0.0, 1.0);
  const double way = 1.2 * (cycle + u - std::sin(2 * kPi * u) / (2 * kPi));
  return {0, 0.06 * (1 - std::cos(2 * kPi * u)), way - 1.2 * phase};
}
Clip cycloid_walk(double rate) {
  return Legs(rate).move(
      5, [](double t) { return Vec3(0, 0, 1.2 * (t - 0.3)); },
      [](double t) { return cycloid(t, 0); }, [](double t) { return cycloid(t, 0.5); });
}

TEST(Cycloid, EventsAreWhereTheFormulaPutsThem) {
  for (const double rate : {30.0, 60.0, 120.0}) {
    const std::vector<Keytime> keys = test::keytimes_of(cycloid_walk(rate));
    test::Hits offs, strikes;
    match({0.6, 1.6, 2.6, 3.6, 4.6}, test::times_of(keys, "left_off"), offs);
    match({1, 2, 3, 4}, test::times_of(keys, "left_strike"), strikes);
    match({0.1, 1.1, 2.1, 3.1, 4.1}, test::times_of(keys, "right_off"), offs);
    match({0.5, 1.5, 2.5, 3.5, 4.5}, test::times_of(keys, "right_strike"), strikes);
    EXPECT_EQ(strikes.share(), 1) << rate;
    EXPECT_EQ(offs.share(), 1) << rate;
    EXPECT_LE(strikes.extra + offs.extra, 1) << rate;  // the strike at the last frame
  }
}

TEST(Cycloid, MetricsOfTheGait) {
  const GaitMetrics gait = gait_metrics(test::keytimes_of(cycloid_walk(120)));
  EXPECT_GE(gait.cycles, 6);
  EXPECT_NEAR(gait.cadence, 120, 1);
  EXPECT_NEAR(gait.stance[0], 0.6, 0.02);
  EXPECT_NEAR(gait.stance[1], 0.6, 0.02);
  EXPECT_NEAR(gait.double_support, 0.2, 0.04);
}

// Would fail if speed or lengths were those of another part of the step, or of the other foot.
TEST(Cycloid, MeasuresOfTheSteps) {
  const Clip clip = cycloid_walk(120);
  const StepMeasures steps =
      step_measures(clip, find_roles(clip.skeleton), test::keytimes_of(clip));
  EXPECT_GE(steps.steps, 6);
  EXPECT_NEAR(steps.speed.value(), 1.2, 0.01);
  EXPECT_NEAR(steps.stride_length.value(), 1.2, 0.005);
  EXPECT_NEAR(steps.step_length[0].value(), 0.6, 0.005);
  EXPECT_NEAR(steps.step_length[1].value(), 0.6, 0.005);
  EXPECT_NEAR(steps.step_width.value(), 0.2, 0.001);
  // In place the way has no direction that lengths could be measured along.
  const Clip still = carried_along(clip, clip.skeleton.find("Hips"), {Vec3(0, 0, -1.2), 0});
  const StepMeasures in_place =
      step_measures(still, find_roles(clip.skeleton), test::keytimes_of(clip));
  EXPECT_LT(in_place.stride_length.value(), 0.01);
  EXPECT_FALSE(in_place.step_length[0] || in_place.step_width);
  const StepMeasures none = step_measures(clip, find_roles(clip.skeleton), {});
  EXPECT_FALSE(none.speed || none.step_width || none.step_length[0]);
}

// Would fail if the feet of one who walks backwards were said to cross.
TEST(Cycloid, StepsBackwardsAreAsWide) {
  samples::WalkOptions options;
  options.steps = 10;
  std::array<double, 2> widths = {};
  for (const bool backward : {false, true}) {
    options.backward = backward;
    const Clip clip = samples::make_walk(options).value().clip;
    const StepMeasures steps =
        step_measures(clip, find_roles(clip.skeleton), test::keytimes_of(clip));
    widths[backward] = steps.step_width.value_or(0);
  }
  EXPECT_GT(widths[0], 0.05);
  EXPECT_NEAR(widths[1], widths[0], 0.02);
}

// Would fail if a dance to and fro passed for a walk, and its steps for a speed.
TEST(Cycloid, StepsToAndFroAreNoGait) {
  Clip clip = cycloid_walk(120);
  const RoleMap roles = find_roles(clip.skeleton);
  const std::vector<Keytime> keys = test::keytimes_of(clip);
  const StepMeasures walk = step_measures(clip, roles, keys);
  EXPECT_EQ(walk.steadiness, 1);
  EXPECT_TRUE(walk.are_steady());
  for (Vec3f& place : clip.positions) {
    const float back = std::fmod(std::abs(place.z()), 2.4f);
    place.z() = std::min(back, 2.4f - back);
  }
  const StepMeasures dance = step_measures(clip, roles, keys);
  EXPECT_EQ(dance.steps, walk.steps);
  EXPECT_LT(dance.steadiness.value(), 0.3);
  EXPECT_FALSE(dance.are_steady());
}

// Would fail if a straight walk of two cycles had no speed, as none of its strides has three whole
// stances.
TEST(Cycloid, StancesThatTheEndsCutCount) {
  samples::WalkOptions options;
  options.steps = 10;
  options.rate = 60;
  const samples::Walk walk = samples::make_walk(options).value();
  const double begin = walk.feet[0].strikes[1] - 0.05;
  const auto first = static_cast<int>(std::lround(begin * 60));
  const auto last = static_cast<int>(std::lround((begin + 3.2 * walk.step_time) * 60));
  const Clip clip = cut(walk.clip, first, last);
  const StepMeasures steps =
      step_measures(clip, find_roles(clip.skeleton), test::keytimes_of(clip));
  EXPECT_GE(steps.steps, 1);
  EXPECT_NEAR(steps.speed.value_or(0), options.step_length / walk.step_time, 0.05);
  EXPECT_NEAR(steps.stride_length.value_or(0), 2 * options.step_length, 0.05);
}

// Would fail if a take that is held for seconds with a foot in the air had its sole where it is
// then, by which a retarget turns feet round.
TEST(Soles, AreNotThoseOfAHeldStart) {
  samples::WalkOptions options;
  options.steps = 10;
  options.rate = 60;
  const Clip walk = samples::make_walk(options).value().clip;
  const RoleMap roles = find_roles(walk.skeleton);
  const auto foot = static_cast<std::size_t>(roles.joint(Role::left_foot));
  const auto toes = static_cast<std::size_t>(roles.joint(Role::left_toes));
  const auto slope = [&](int f) {
    return walk.frame_positions(f)[toes].y() - walk.frame_positions(f)[foot].y();
  };
  int steepest = 0;
  for (int f = 0; f < walk.frame_count() / 2; ++f) {
    if (slope(f) < slope(steepest)) steepest = f;
  }
  constexpr int kHeld = 300;
  Clip held = walk;
  held.resize(kHeld + walk.frame_count() - steepest);
  std::vector<Transform> pose(walk.skeleton.reference.size());
  for (int f = 0; f < held.frame_count(); ++f) {
    walk.get_pose(steepest + std::max(0, f - kHeld), pose);
    held.set_pose(f, pose);
  }
  const Vec3 heel = find_feet(walk, roles).points[0].front().offset;
  EXPECT_LT((find_feet(held, roles).points[0].front().offset - heel).norm(), 0.005);
}

// Would fail if steps on the spot passed for a walk or a run.
TEST(Cycloid, StepsOnTheSpotAreNoGait) {
  samples::WalkOptions options;
  options.steps = 10;
  const auto measured = [&] {
    const Clip clip = samples::make_walk(options).value().clip;
    return step_measures(clip, find_roles(clip.skeleton), test::keytimes_of(clip));
  };
  EXPECT_TRUE(measured().are_gait());
  options.step_length = 0;
  EXPECT_FALSE(measured().are_gait());
  options.turn = 40 * kRadiansPerDegree;
  EXPECT_FALSE(measured().are_gait());
}

TEST(Cycloid, PlacesAreTheJoints) {
  const std::vector<Contact> contacts = contacts_of(cycloid_walk(60), "LeftToeBase");
  ASSERT_GE(contacts.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((contacts[i].place - Vec3(0.1, 0.02, 0.13 + 1.2 * static_cast<double>(i))).norm(),
              0.005);
  }
}

TEST(Standing, IsOneContactAndNoStep) {
  const Clip clip = Legs(60).move(2, still, still, still);
  for (const char* joint : {"LeftFoot", "RightToeBase", "LeftToe_end"}) {
    const std::vector<Contact> contacts = contacts_of(clip, joint);
    ASSERT_EQ(contacts.size(), 1U) << joint;
    EXPECT_EQ(contacts[0].start, 0);
    EXPECT_EQ(contacts[0].end, 2);
  }
  EXPECT_TRUE(test::keytimes_of(clip).empty());
  const RoleMap roles = find_roles(clip.skeleton);
  const Gait gait = find_gait(clip, roles, *find_contacts(clip, roles));
  ASSERT_EQ(gait.warnings.size(), 1U);
  EXPECT_EQ(gait.warnings[0].code, "gait-none");
}

// A leg held up beside the other is still, but stands on nothing.
TEST(OneLeg, HeldUpIsNoContact) {
  const auto lifted = [](double t) -> Vec3 {
    const double u = std::clamp(t - 1, 0.0, 1.0) - std::clamp(t - 4, 0.0, 1.0);
    return {0, 0.15 * (1 - std::cos(kPi * u)), 0.05 * u};
  };
  const Clip clip = Legs(60).move(6, still, still, lifted);
  for (const Contact& contact : contacts_of(clip, "RightToeBase")) {
    EXPECT_LT(contact.place.y(), 0.05) << contact.start;
  }
  EXPECT_EQ(contacts_of(clip, "RightToeBase").size(), 2U);
  EXPECT_EQ(contacts_of(clip, "LeftToeBase").size(), 1U);
}

// Up a step of 30 cm: the higher foot bears the figure once the other one is lifted.
TEST(OneStep, OnAHighLevelIsAContact) {
  const auto foot = [](double t, double start) -> Vec3 {
    const double u = std::clamp((t - start) / 0.5, 0.0, 1.0);
    return {0, 0.3 * u + 0.1 * std::sin(kPi * u), 0.35 * u};
  };
  const Clip clip = Legs(60).move(
      4, [&](double t) { return foot(t / 2, 0.5); }, [&](double t) { return foot(t, 1); },
      [&](double t) { return foot(t, 2); });
  const std::vector<Contact> left = contacts_of(clip, "LeftToeBase");
  ASSERT_EQ(left.size(), 2U);
  EXPECT_NEAR(left[1].place.y(), 0.32, 0.005);
  EXPECT_NEAR(left[1].start, 1.5, 0.03);
}

// A jump on the spot: both feet leave and come down together.
TEST(Jump, BothFeetLeaveAndLand) {
  const auto ballistic = [](double t) -> Vec3 {
    const double u = t - 1;
    return {0, u > 0 && u < 0.5 ? 0.5 * 9.81 * u * (0.5 - u) : 0, 0};
  };
  const std::vector<Keytime> keys =
      test::keytimes_of(Legs(120).move(2.5, ballistic, ballistic, ballistic));
  ASSERT_EQ(keys.size(), 4U);
  for (const char* side : {"left", "right"}) {
    const auto off = test::times_of(keys, std::string(side) + "_off");
    const auto strike = test::times_of(keys, std::string(side) + "_strike");
    ASSERT_EQ(off.size(), 1U);
    ASSERT_EQ(strike.size(), 1U);
    EXPECT_NEAR(off[0], 1, 1.0 / 60);
    EXPECT_NEAR(strike[0], 1.5, 1.0 / 60);
  }
  for (std::size_t i = 1; i < keys.size(); ++i) EXPECT_GE(keys[i].time, keys[i - 1].time + 9e-6);
}

// A sprint of 8 m/s, 0.5 s a cycle: a foot that never stops but slides at 0.6 m/s for 0.1 s, speeds
// up evenly for 0.2 s and slows down again. Its landing is where it has 0.12 of its greatest speed.
struct Sprint {
  static constexpr double cycle = 0.5, slide = 0.6, stance = 0.1, rise = 0.2;
  static constexpr double most = (8 * cycle - slide * stance) / rise - slide;  // m/s
  static constexpr double gain = (most - slide) / rise;                        // m/s per second
  static constexpr double landing = cycle - (0.12 * most - slide) / gain;      // s, in a cycle

  static Vec3 foot(double t, double phase) {
    const double whole = std::floor((t + phase) / cycle), u = t + phase - cycle * whole;
    const double up = std::clamp(u - stance, 0.0, rise), down = std::max(0.0, u - stance - rise);
    const double way =
        slide * u + 0.5 * gain * up * up + (most - slide) * down - 0.5 * gain * down * down;
    const double swing = std::clamp((u - stance) / (2 * rise), 0.0, 1.0);
    return {0, 0.15 * (1 - std::cos(2 * kPi * swing)), 8 * (cycle * whole - phase) + way};
  }
};
TEST(Sprint, LandsWhereTheSlidingFootHasSlowedDown) {
  for (const double rate : {60.0, 120.0}) {
    const Clip clip = Legs(rate).move(
        4, [](double t) { return Vec3(0, 0, 8 * (t - 0.05)); },
        [](double t) { return Sprint::foot(t, 0); },
        [](double t) { return Sprint::foot(t, Sprint::cycle / 2); });
    const std::vector<Keytime> keys = test::keytimes_of(clip);
    std::vector<double> left, right;
    for (int step = 0; step < 8; ++step) {
      if (step < 7) left.push_back(Sprint::landing + Sprint::cycle * step);
      right.push_back(Sprint::landing + Sprint::cycle * (step - 0.5));
    }
    test::Hits strikes;
    match(left, test::times_of(keys, "left_strike"), strikes);
    match(right, test::times_of(keys, "right_strike"), strikes);
    EXPECT_EQ(strikes.share(), 1) << rate;
  }
}

// Feet on pedals go to and fro and never stand.
TEST(Pedalling, HasNoSteps) {
  const auto pedal = [](double t, double phase) -> Vec3 {
    const double a = 2 * kPi * (1.2 * t + phase);
    return {0, 0.3 + 0.17 * std::sin(a), 0.17 * std::cos(a)};
  };
  const Clip clip = Legs(60).move(
      5, still, [&](double t) { return pedal(t, 0); }, [&](double t) { return pedal(t, 0.5); });
  EXPECT_TRUE(test::keytimes_of(clip).empty());
}

// On a treadmill nothing stays; the feet's turning points give the steps, and a warning says so.
TEST(Treadmill, StepsComeFromTheSeedsWithAWarning) {
  const auto belt = [](double t) { return Vec3(0, 0, -1.2 * t); };
  const Clip clip = Legs(60).move(
      5, still, [&](double t) -> Vec3 { return cycloid(t, 0) + belt(t); },
      [&](double t) -> Vec3 { return cycloid(t, 0.5) + belt(t); });
  const RoleMap roles = find_roles(clip.skeleton);
  const auto found = find_contacts(clip, roles);
  ASSERT_TRUE(found.ok());
  const Gait gait = find_gait(clip, roles, *found);
  test::Hits strikes;
  match({1, 2, 3, 4}, test::times_of(gait.keytimes, "left_strike"), strikes);
  EXPECT_EQ(strikes.matched, 4);
  EXPECT_LT(strikes.rms(), 0.1);
  ASSERT_FALSE(gait.warnings.empty());
  EXPECT_EQ(gait.warnings[0].code, "gait-in-place");
}

// A rest pose as first frame is no movement.
TEST(RestPose, BeforeTheCaptureIsPassedOver) {
  Clip clip = cycloid_walk(60);
  const std::vector<Keytime> keys = test::keytimes_of(clip);
  for (Vec3f& p : clip.frame_positions(0)) p += Vec3f(3, 0.5F, -2);
  const std::vector<Keytime> same = test::keytimes_of(clip);
  ASSERT_EQ(keys.size(), same.size());
  for (std::size_t i = 0; i < keys.size(); ++i) EXPECT_NEAR(keys[i].time, same[i].time, 0.02);
}

TEST(SlideSpeed, IsThatOfTheSlowerFootAlongTheGround) {
  const auto slide = [](const Clip& clip) { return slide_speed(clip, find_roles(clip.skeleton)); };
  EXPECT_NEAR(slide(cycloid_walk(60)), 0, 1e-4);
  // One foot slides at 0.3 m/s, the other at 0.5; up and down is no sliding.
  const Clip skating = Legs(60).move(
      2, still, [](double t) { return Vec3(0.3 * t, 0.05 * std::sin(9 * t), 0); },
      [](double t) { return Vec3(0, 0, 0.5 * t); });
  EXPECT_NEAR(slide(skating), 0.3, 1e-4);
  for (const int frames : {0, 1}) {
    Clip clip = skating;
    clip.resize(frames);
    EXPECT_EQ(slide(clip), 0) << frames;
  }
  Clip stick;
  stick.skeleton.add("a", Skeleton::kNoParent, {});
  stick.resize(10);
  EXPECT_EQ(slide(stick), 0);
}

TEST(Degenerate, ClipsOfFewFramesAndNoFeet) {
  for (const int frames : {0, 1, 2, 3, 4, 7}) {
    Clip clip = cycloid_walk(60);
    clip.resize(frames);
    const RoleMap roles = find_roles(clip.skeleton);
    const auto found = find_contacts(clip, roles);
    ASSERT_TRUE(found.ok()) << frames;
    const Gait gait = find_gait(clip, roles, *found);
    EXPECT_TRUE(check({found->contacts, gait.keytimes}, clip.skeleton, clip.duration()).ok());
    if (frames < 3) {
      EXPECT_EQ(found->warnings.at(0).code, "contacts-short");
    }
  }
  Clip stick;
  stick.skeleton.add("a", Skeleton::kNoParent, {});
  stick.resize(10);
  const auto none = find_contacts(stick, find_roles(stick.skeleton));
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, "contacts-feet");
}

// A leg of length 0, or one leg alone, must not divide by it.
TEST(Degenerate, LegsOfLengthZeroAndOneLeg) {
  Clip clip = cycloid_walk(60);
  for (Transform& joint : clip.skeleton.reference) joint.position = Vec3(0, 1, 0);
  EXPECT_FALSE(find_contacts(clip, find_roles(clip.skeleton)).ok());
  const Clip one =
      test::without(cycloid_walk(60), {"RightUpLeg", "RightLeg", "RightFoot", "RightToe"});
  const auto found = find_contacts(one, find_roles(one.skeleton));
  if (!found) return;
  EXPECT_TRUE(test::times_of(test::keytimes_of(one), "right_strike").empty());
}

TEST(Again, TheSameBytes) {
  const Clip clip = cycloid_walk(60);
  const auto a = test::keytimes_of(clip), b = test::keytimes_of(clip);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].time, b[i].time);
}

}  // namespace
}  // namespace krok
