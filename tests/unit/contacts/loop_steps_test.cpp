// Loops in place, as packs of game animations have them. If these fail, their steps are not found,
// so that they cannot be blended, or an engine moves them at a speed at which feet slide.

#include "contacts/loop_steps.h"

#include <gtest/gtest.h>

#include "events.h"
#include "motion/hips_root.h"
#include "motion/sample.h"
#include "motion/travel.h"

namespace krok {
namespace {

constexpr double kLoopRate = 30;
constexpr int kLoopPeriod = 30;  // frames, of two steps

// Two steps of a generated walk, in place, that begin at a frame.
Clip loop_in_place(double step_length, int first, samples::WalkOptions options = {}) {
  options.cadence = 120;
  options.steps = 10;
  options.rate = kLoopRate;
  options.step_length = step_length;
  Clip walk = samples::make_walk(options).value().clip;
  const int carrier = carrying_joint(find_roles(walk.skeleton));
  Clip loop = cut(walk, first, first + kLoopPeriod);
  loop = in_place(loop, carrier, Travel::trend);
  loop.provenance = {};
  return loop;
}

TEST(LoopSteps, FeetShowTheSpeed) {
  for (const double length : {0.4, 0.7}) {
    const Clip loop = loop_in_place(length, 70);
    const RoleMap roles = find_roles(loop.skeleton);
    const auto displacement = loop_displacement(loop, carrying_joint(roles));
    ASSERT_TRUE(displacement);
    EXPECT_TRUE(is_in_place(*displacement, loop.skeleton));
    const Vec3 velocity = velocity_of_feet(loop, roles);
    EXPECT_NEAR(velocity.z(), 2 * length, 0.04 * 2 * length);
    EXPECT_NEAR(velocity.x(), 0, 0.02);
  }
}

TEST(LoopSteps, BackwardsIsBackwards) {
  samples::WalkOptions options;
  options.backward = true;
  const Clip loop = loop_in_place(0.5, 70, options);
  const Vec3 velocity = velocity_of_feet(loop, find_roles(loop.skeleton));
  EXPECT_NEAR(velocity.z(), -1, 0.06);
}

TEST(LoopSteps, WhoStandsDoesNotTravel) {
  Clip loop = loop_in_place(0.7, 70);
  for (int f = 1; f < loop.frame_count(); ++f) {  // a pose that sways
    const Vec3f sway = Vec3f(0.02F * std::sin(2 * float(kPi) * float(f) / kLoopPeriod), 0, 0);
    for (std::size_t j = 0; j < loop.skeleton.names.size(); ++j) {
      loop.frame_positions(f)[j] = loop.frame_positions(0)[j] + sway;
      loop.frame_orientations(f)[j] = loop.frame_orientations(0)[j];
    }
  }
  EXPECT_EQ(velocity_of_feet(loop, find_roles(loop.skeleton)), Vec3(0, 0, 0));
  EXPECT_FALSE(travelling_on_feet(loop, find_roles(loop.skeleton)));
}

// Wherever the loop begins, its events are those of the walk, on the circle.
TEST(LoopSteps, EventsAreOnACircle) {
  for (const int first : {60, 67, 75, 82}) {
    const Clip loop = loop_in_place(0.7, first);
    const RoleMap roles = find_roles(loop.skeleton);
    const auto steps = find_steps(loop, roles);
    ASSERT_TRUE(steps);
    for (const char* name : {"left_strike", "left_off", "right_strike", "right_off"}) {
      const std::vector<double> times = test::times_of(steps->gait.keytimes, name);
      // At the seam it is at both ends.
      ASSERT_GE(times.size(), 1U) << name << ", from frame " << first;
      ASSERT_LE(times.size(), 2U) << name;
      EXPECT_NEAR(times.back() - times.front(), times.size() == 2 ? loop.duration() : 0,
                  1 / kLoopRate);
    }
    EXPECT_FALSE(steps->contacts.contacts.empty());
    for (const Contact& contact : steps->contacts.contacts) {
      EXPECT_GE(contact.start, 0);
      EXPECT_LE(contact.end, loop.duration());
    }
    // The feet of a walk take turns, half a cycle apart.
    const double left = test::times_of(steps->gait.keytimes, "left_strike")[0];
    const double right = test::times_of(steps->gait.keytimes, "right_strike")[0];
    EXPECT_NEAR(std::abs(left - right), 0.5 * loop.duration(), 1.5 / kLoopRate);
    const auto rounds = rounds_of(loop, roles);
    ASSERT_TRUE(rounds);
    EXPECT_NEAR(rounds->displacement.position.z(), 1.4, 0.05);
  }
}

// Would fail if a part of a walk, which does not repeat, were played as if it did.
TEST(LoopSteps, APartOfAStepIsNoLoop) {
  const Clip walk = loop_in_place(0.7, 60);
  const Clip part = cut(walk, 0, 20);
  EXPECT_FALSE(loop_displacement(part, carrying_joint(find_roles(part.skeleton))));
}

}  // namespace
}  // namespace krok
