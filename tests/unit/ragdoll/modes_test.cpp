// If these fail, animated bodies are moved by what they touch or do not move what hangs from them
// by Newton's laws, and powered or held ones follow with other strengths than documented.

#include <gtest/gtest.h>

#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "ragdoll/motion_follower.h"
#include "ragdoll/world.h"

namespace krok::ragdoll::modes_test {
namespace {

constexpr double kWeight = 9.81;

Body part(const std::string& name, double mass, BodyMode mode) {
  Body body;
  body.name = name;
  body.shape.half = Vec3(0.04, 0.2, 0.04);
  body.mass = mass;
  body.mode = mode;
  return body;
}

// A ball joint, 0.3 m above the child's centre and 0.1 m below the parent's.
Joint ball_joint() {
  Joint joint;
  joint.parent = 0;
  joint.child = 1;
  joint.in_parent.position = Vec3(0, -0.1, 0);
  joint.in_child.position = Vec3(0, 0.3, 0);
  return joint;
}

std::vector<BodyState> base_and_below() {
  std::vector<BodyState> states(2);
  states[0].to_world.position = Vec3(0, 2, 0);
  states[1].to_world.position = Vec3(0, 1.6, 0);
  return states;
}

// Below a base that accelerates with a, what hangs from it leans back by atan(a / g): gravity and
// the base's acceleration are one field. If the base's movement did not reach the joint, or its
// reaction moved the base, it would hang straight or swing elsewhere.
TEST(RagdollModes, WhatHangsFromAnAcceleratingBaseLeansBack) {
  for (const double acceleration : {2.0, 9.81}) {
    World world(WorldOptions{}, Surroundings{});
    Joint joint = ball_joint();
    joint.friction = 2;
    ASSERT_TRUE(world
                    .add(std::vector{part("base", 10, BodyMode::animated),
                                     part("below", 4, BodyMode::simulated)},
                         base_and_below(), std::vector{joint})
                    .ok());
    for (int step = 1; step <= 240 * 6; ++step) {
      const double time = step * World::kStep;
      world.lead(0, {Vec3(0.5 * acceleration * time * time, 2, 0), Quat::Identity()});
      world.step();
    }
    const Vec3 down = world.state(1).to_world.orientation * Vec3(0, -1, 0);
    EXPECT_NEAR(std::atan2(-down.x(), -down.y()), std::atan2(acceleration, kWeight), 2e-3)
        << acceleration;
    EXPECT_LT(world.measures().joint_gap, 1e-9);
  }
}

// Infinite mass: neither a push nor a box that is thrown at it moves it, not by a bit, while the
// box bounces back or falls.
TEST(RagdollModes, AnAnimatedBodyIsNotMovedByPushesOrContacts) {
  World world(WorldOptions{}, Surroundings{});
  std::vector<BodyState> states(2);
  states[0].to_world.position = Vec3(0, 1, 0);
  states[1].to_world.position = Vec3(-0.5, 1, 0);
  states[1].velocity = Vec3(6, 1, 0);
  ASSERT_TRUE(world
                  .add(std::vector{part("wall", 1, BodyMode::animated),
                                   part("thrown", 50, BodyMode::simulated)},
                       states, {})
                  .ok());
  double nearest = 0.5;
  for (int step = 0; step < 60; ++step) {
    world.push(0, Vec3(100, 50, 0));
    world.lead(0, states[0].to_world);
    world.step();
    EXPECT_EQ(world.state(0).to_world.position, states[0].to_world.position);
    nearest = std::min(nearest, -world.state(1).to_world.position.x());
  }
  EXPECT_GT(nearest, 0.07);  // it does not go through
  EXPECT_LT(nearest, 0.1);   // but gets there
}

// It is where it was led after each step, to rounding, also turning and with parts of a step.
TEST(RagdollModes, AnAnimatedBodyIsWhereItWasLed) {
  for (const int substeps : {1, 3}) {
    WorldOptions options;
    options.substeps = substeps;
    World world(options, Surroundings{});
    ASSERT_TRUE(world
                    .add(std::vector{part("base", 10, BodyMode::animated),
                                     part("below", 4, BodyMode::simulated)},
                         base_and_below(), std::vector{ball_joint()})
                    .ok());
    for (int step = 1; step <= 240; ++step) {
      const double t = step * World::kStep;
      const Transform pose{Vec3(std::sin(4 * t), 2 + 0.2 * std::cos(9 * t), t),
                           from_rotation_vector(Vec3(2 * std::sin(3 * t), t, -2 * t))};
      world.lead(0, pose);
      world.step();
      ASSERT_LT((world.state(0).to_world.position - pose.position).norm(), 1e-9);
      ASSERT_LT(angle_between(world.state(0).to_world.orientation, pose.orientation), 1e-7);
    }
    EXPECT_LT(world.measures().joint_gap, 1e-9);
  }
}

// An anchor that moves in its parent takes the child along, as a collar bone does with an arm: at
// last it hangs straight below, as fast as the anchor.
TEST(RagdollModes, AMovingAnchorTakesTheChildAlong) {
  World world(WorldOptions{}, Surroundings{});
  Joint joint = ball_joint();
  joint.friction = 2;
  ASSERT_TRUE(world
                  .add(std::vector{part("base", 10, BodyMode::animated),
                                   part("below", 4, BodyMode::simulated)},
                       base_and_below(), std::vector{joint})
                  .ok());
  const double speed = 0.2;
  for (int step = 1; step <= 240 * 5; ++step) {
    world.lead(0, base_and_below()[0].to_world);
    world.move_anchor(0, Vec3(0, -0.1, speed * step * World::kStep));
    world.step();
  }
  EXPECT_LT(world.measures().joint_gap, 1e-9);
  EXPECT_NEAR(world.state(1).to_world.position.z(), speed * 5, 2e-3);
  EXPECT_NEAR(world.state(1).velocity.z(), speed, 5e-3);
}

// Below what is simulated nothing can be animated: the base would have to move what it hangs from.
TEST(RagdollModes, AnimatedBelowSimulatedIsRefused) {
  World world(WorldOptions{}, Surroundings{});
  const Status status = world.add(
      std::vector{part("base", 10, BodyMode::simulated), part("below", 4, BodyMode::animated)},
      base_and_below(), std::vector{ball_joint()});
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "ragdoll-mode");
}

// add_motors(): k = I w^2 with w = 60 s holds a limb straight out with m g l / k to spare; what is
// stronger than the largest torque is let go.
TEST(RagdollModes, APoweredLimbHoldsItsWeightAsItsStrengthSays) {
  const double arm = 0.3, mass = 4;
  const double inertia = mass * ((0.4 * 0.4 + 0.08 * 0.08) / 12 + arm * arm);
  for (const double strength : {1.0, 0.5, 0.2}) {
    std::vector<Body> bodies{part("base", 10, BodyMode::animated),
                             part("below", mass, BodyMode::powered)};
    bodies[0].joint = 0;
    bodies[1].joint = 1;
    bodies[1].parent = 0;
    bodies[1].strength = strength;
    RoleMap roles;
    roles.roles.assign(2, Role::none);
    std::vector<Joint> joints{ball_joint()};
    const auto states = base_and_below();
    add_motors(bodies, roles, states, joints);
    // Three times what holds it straight out.
    EXPECT_NEAR(joints[0].motor, strength * 3 * mass * kWeight * arm, 1e-9);
    const double stiffness = inertia * std::pow(kMotorFrequency * strength, 2);
    EXPECT_NEAR(joints[0].motor_stiffness, stiffness, 1e-9);
    World world(WorldOptions{}, Surroundings{});
    ASSERT_TRUE(world.add(bodies, states, joints).ok());
    const Quat out = from_rotation_vector(Vec3(0, 0, 0.5 * kPi));
    for (int step = 0; step < 240 * 4; ++step) {
      world.set_motor(0, out, Vec3::Zero());
      world.step();
    }
    const double raised = angle_between(world.state(1).to_world.orientation, Quat::Identity());
    if (strength < 1.0 / 3) {
      EXPECT_LT(std::sin(raised), 0.95) << strength;
      continue;
    }
    const double weight = mass * kWeight * arm * std::sin(raised);
    EXPECT_NEAR(0.5 * kPi - raised, weight / stiffness, 0.01 * weight / stiffness) << strength;
  }
}

// A held body that gets a speed v moves by v t exp(-w t) and comes back, w = 6 s / (1 - s): a
// critically damped spring. Its weight is carried besides.
TEST(RagdollModes, AHeldBodySwingsBackWithoutSwingingOver) {
  for (const double strength : {0.3, 0.5, 0.8}) {
    std::vector<Body> bodies{part("held", 20, BodyMode::powered)};
    bodies[0].strength = strength;
    std::vector<BodyState> states(1);
    states[0].to_world.position = Vec3(0, 1, 0);
    Hold hold = make_hold(bodies, states);
    hold.target = states[0].to_world;
    hold.support = Vec3(0, 20 * kWeight, 0);
    World world(WorldOptions{}, Surroundings{});
    ASSERT_TRUE(world.add(bodies, states, {}).ok());
    world.hold(0, hold);
    const double speed = 0.4, frequency = 6 * strength / (1 - strength);
    world.push(0, Vec3(20 * speed, 0, 0));
    for (int step = 1; step <= 480; ++step) {
      world.step();
      const double t = step * World::kStep;
      const double expected = speed * t * std::exp(-frequency * t);
      // Implicit steps lag by up to a step.
      ASSERT_NEAR(world.state(0).to_world.position.x(), expected,
                  0.06 * speed / (frequency * std::exp(1)))
          << strength << ' ' << t;
      ASSERT_NEAR(world.state(0).to_world.position.y(), 1, 1e-6);
    }
  }
}

// Turned, it comes back as w t exp(-2 w t): twice as fast.
TEST(RagdollModes, AHeldBodyTurnsBackTwiceAsFast) {
  std::vector<Body> bodies{part("held", 20, BodyMode::powered)};
  bodies[0].strength = 0.5;
  std::vector<BodyState> states(1);
  states[0].spin = Vec3(0.5, 0, 0);
  Hold hold = make_hold(bodies, states);
  WorldOptions options;
  options.gravity = Vec3::Zero();
  World world(options, Surroundings{});
  ASSERT_TRUE(world.add(bodies, states, {}).ok());
  world.hold(0, hold);
  for (int step = 1; step <= 240; ++step) {
    world.step();
    const double t = step * World::kStep;
    const double turned = rotation_vector(world.state(0).to_world.orientation).x();
    ASSERT_NEAR(turned, 0.5 * t * std::exp(-12 * t), 0.06 * 0.5 / (12 * std::exp(1))) << t;
  }
}

// Its force is limited: far away, it accelerates with 3 s / (1 - s) g and no more.
TEST(RagdollModes, AHoldPullsWithItsLargestForceAtMost) {
  std::vector<Body> bodies{part("held", 20, BodyMode::powered)};
  bodies[0].strength = 0.25;
  std::vector<BodyState> states(1);
  Hold hold = make_hold(bodies, states);
  hold.target.position = Vec3(100, 0, 0);
  hold.support = Vec3(0, 20 * kWeight, 0);
  World world(WorldOptions{}, Surroundings{});
  ASSERT_TRUE(world.add(bodies, states, {}).ok());
  world.hold(0, hold);
  for (int step = 0; step < 24; ++step) world.step();
  EXPECT_NEAR(world.state(0).velocity.x(), 0.1 * kWeight, 0.02 * kWeight * 0.1);
}

}  // namespace
}  // namespace krok::ragdoll::modes_test
