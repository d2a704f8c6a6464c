// If these fail, a foot that comes down on its heel, on its ball or flat is taken to stand in three
// different places.

#include "parametric/footprint.h"

#include <gmock/gmock.h>

#include "math/quaternion.h"
#include "walks.h"

namespace krok::parametric {
namespace {

// Ankle 8 cm above the sole and 6 cm before the heel, 18 cm from heel to ball; the foot's frame is
// turned, as rigs have it.
const Quat kTurned = Quat(0.5, 0.5, -0.5, 0.5);
FootShape shape() {
  const Quat back = kTurned.conjugate();
  return {3, back * Vec3(0, -0.08, -0.06), back * Vec3::UnitZ(), 0.18};
}

// The foot with its print at `place`, turned by `heading` and pitched about its heel (toes up) or
// about its ball (toes down).
Transform pose_of(const FootShape& foot, const Vec3& place, double heading, double pitch) {
  const Quat turn = axis_rotation(Axis::y, heading) * axis_rotation(Axis::x, -pitch) * kTurned;
  const Vec3 ball = place + axis_rotation(Axis::y, heading) * Vec3(0, 0, foot.length);
  if (pitch >= 0) return {place - turn * foot.heel, turn};
  return {ball - turn * ball_of(foot), turn};
}

TEST(Footprint, IsTheSameAtEveryPitch) {
  const Vec3 place(1.5, 0.2, -3);
  for (const double heading : {0.0, 0.4, -2.0, 3.1}) {
    for (const double pitch : {-1.2, -0.3, -1e-9, 0.0, 1e-9, 0.35, 1.2}) {
      const Footprint print = footprint(shape(), pose_of(shape(), place, heading, pitch));
      EXPECT_LT((print.place - place).norm(), 1e-8) << heading << " " << pitch;
      EXPECT_NEAR(print.heading, heading, 1e-9) << pitch;
    }
  }
}

TEST(Footprint, WithoutABallIsTheHeel) {
  FootShape foot = shape();
  foot.length = 0;
  const Transform pose = pose_of(shape(), Vec3(0, 0, 0), 0.5, -0.4);
  EXPECT_LT((footprint(foot, pose).place - pose * foot.heel).norm(), 1e-12);
}

TEST(Footprint, OfAFootOnItsTipsHasNoHeading) {
  const Footprint print = footprint(shape(), pose_of(shape(), Vec3(0, 0, 0), 0.5, kPi / 2));
  EXPECT_EQ(print.heading, 0);
  EXPECT_LT(print.place.norm(), 1e-9);
}

TEST(Footprint, FrameTakesTheToesToTheHeading) {
  const Footprint print{Vec3(1, 2, 3), 0.7};
  EXPECT_LT(
      (print.to_world() * Vec3(0, 0, 1) - Vec3(1 + std::sin(0.7), 2, 3 + std::cos(0.7))).norm(),
      1e-12);
}

// The generator knows its soles: straight below and before the ankle.
TEST(FootShapes, AreThoseOfTheGeneratedActor) {
  const auto walk = test::keyed_walk({});
  const RoleMap roles = find_roles(walk.walk.clip.skeleton);
  const ClipContacts clips[] = {{&walk.walk.clip, &walk.found}};
  const auto shapes = find_foot_shapes(clips, roles);
  ASSERT_TRUE(shapes.ok());
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    const FootShape& foot = (*shapes)[static_cast<std::size_t>(side)];
    const auto& legs = walk.walk.actor.legs[static_cast<std::size_t>(side)];
    EXPECT_EQ(foot.joint, legs.foot);
    EXPECT_LT((foot.heel - walk.walk.actor.heel).norm(), 0.012);
    EXPECT_NEAR(foot.forward.z(), 1, 1e-3);
    EXPECT_NEAR(foot.forward.x(), 0, 1e-3);
    EXPECT_NEAR(foot.length, walk.walk.actor.ball.z() - walk.walk.actor.heel.z(), 0.012);
  }
  // Without contacts the reference pose tells which way is up.
  const ClipContacts bare[] = {{&walk.walk.clip, nullptr}};
  const auto guessed = find_foot_shapes(bare, roles);
  ASSERT_TRUE(guessed.ok());
  EXPECT_GT((*guessed)[0].forward.dot((*shapes)[0].forward), 0.999);
}

// On a slope a flat foot is tilted: where there is a level walk it alone counts.
TEST(FootShapes, WalksThatClimbDoNotCountBesideLevelOnes) {
  samples::WalkOptions slope;
  slope.rise = 0.05;
  slope.ground = samples::Ground::slope;
  const auto level = test::keyed_walk({}), climbing = test::keyed_walk(slope);
  const RoleMap roles = find_roles(level.walk.clip.skeleton);
  const ClipContacts one[] = {{&level.walk.clip, &level.found}};
  const ClipContacts both[] = {{&climbing.walk.clip, &climbing.found},
                               {&level.walk.clip, &level.found}};
  const ClipContacts other[] = {{&climbing.walk.clip, &climbing.found}};
  const auto wanted = find_foot_shapes(one, roles), found = find_foot_shapes(both, roles),
             tilted = find_foot_shapes(other, roles);
  EXPECT_LT(((*wanted)[0].heel - (*found)[0].heel).norm(), 1e-12);
  EXPECT_GT(((*wanted)[0].forward - (*tilted)[0].forward).norm(), 0.01);
}

TEST(FootShapes, AreRefusedWhereThereAreNoFeet) {
  const auto walk = test::keyed_walk({});
  RoleMap roles = find_roles(walk.walk.clip.skeleton);
  std::ranges::fill(roles.roles, Role::none);
  const ClipContacts clips[] = {{&walk.walk.clip, nullptr}};
  EXPECT_EQ(find_foot_shapes(clips, roles).error().code, "parametric-feet");
}

}  // namespace
}  // namespace krok::parametric
