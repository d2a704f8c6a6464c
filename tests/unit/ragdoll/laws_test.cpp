// If these fail, bodies do not move by Newton's laws: pendulums keep another time, limits give way
// or do not push back, boxes slide where friction holds them.

#include <gtest/gtest.h>

#include <cmath>

#include "math/quaternion.h"
#include "ragdoll/world.h"

namespace krok::ragdoll {
namespace {

constexpr double kGravity = 9.81;

Body box(const Vec3& half, double mass) {
  Body body;
  body.name = "box";
  body.shape.half = half;
  body.mass = mass;
  return body;
}

// A hinge at the world's origin about z, below which a body hangs from `arm` metres.
Joint hinge_in_origin(double arm) {
  Joint joint;
  joint.kind = JointKind::revolute;
  const Quat x_to_z = shortest_arc(Vec3::UnitX(), Vec3::UnitZ());
  joint.in_parent = {Vec3::Zero(), x_to_z};
  joint.in_child = {Vec3(0, arm, 0), x_to_z};
  return joint;
}

// Of the body about z, from hanging straight down.
double angle_of(const World& world) {
  const Vec3 down = world.state(0).to_world.orientation * Vec3(0, -1, 0);
  return std::atan2(down.x(), -down.y());
}

BodyState hanging(double arm, double angle, double spin) {
  BodyState state;
  state.to_world.orientation = from_rotation_vector(Vec3(0, 0, angle));
  state.to_world.position = state.to_world.orientation * Vec3(0, -arm, 0);
  state.spin = Vec3(0, 0, spin);
  state.velocity = state.spin.cross(state.to_world.position);
  return state;
}

// Moment of inertia of the box about z, and about the hinge.
double inertia(const Body& body, double arm) {
  const Vec3 size = 2 * body.shape.half;
  return body.mass * ((size.x() * size.x() + size.y() * size.y()) / 12 + arm * arm);
}

// Seconds between upward zero crossings of `value(world)`, the mean of some.
template <typename Value>
double period(World& world, const Value& value, int periods) {
  double before = value(world), first = -1, last = -1;
  int seen = 0;
  for (int step = 1; step < 240 * 60 && seen <= periods; ++step) {
    world.step();
    const double now = value(world);
    if (before < 0 && now >= 0) {
      last = (step - now / (now - before)) * World::kStep;
      if (seen++ == 0) first = last;
    }
    before = now;
  }
  EXPECT_EQ(seen, periods + 1);
  return (last - first) / periods;
}

// T = 2 pi sqrt(I / (m g l)) (1 + a^2/16) for a swing of a radians.
TEST(RagdollLaws, APendulumKeepsItsPeriod) {
  for (const double arm : {0.3, 1.0}) {
    const Body body = box({0.05, 0.2, 0.05}, 4);
    World world(WorldOptions{}, Surroundings{});
    const double swing = 0.2;
    ASSERT_TRUE(world
                    .add(std::vector{body}, std::vector{hanging(arm, swing, 0)},
                         std::vector{hinge_in_origin(arm)})
                    .ok());
    const double expected = 2 * kPi * std::sqrt(inertia(body, arm) / (body.mass * kGravity * arm)) *
                            (1 + swing * swing / 16);
    EXPECT_NEAR(period(world, angle_of, 5), expected, 0.01 * expected);
  }
}

// Thrown against its limit, a hinge stops there: not 1 % of the range further.
TEST(RagdollLaws, AHingeStopsAtItsHardLimit) {
  for (const double spin : {1.0, 8.0, 30.0}) {
    WorldOptions options;
    options.gravity = Vec3::Zero();
    World world(options, Surroundings());
    Joint joint = hinge_in_origin(0.3);
    joint.range = {-0.5, 1.2};
    ASSERT_TRUE(world
                    .add(std::vector{box({0.05, 0.2, 0.05}, 4)}, std::vector{hanging(0.3, 0, spin)},
                         std::vector{joint})
                    .ok());
    double largest = -10;
    for (int step = 0; step < 480; ++step) {
      world.step();
      largest = std::max(largest, angle_of(world));
    }
    EXPECT_NEAR(largest, 1.2, 0.012) << spin;
    EXPECT_LT(world.measures().limit_excess, 0.012);
    EXPECT_LT(world.measures().joint_gap, 1e-4);
  }
}

// A hand in the belly's box must be able to leave it, and not be shot out of it; what once held of
// such a pair must not act on.
TEST(RagdollLaws, BodiesThatBeginInsideOneAnotherLetEachOtherBe) {
  WorldOptions options;
  options.gravity = Vec3::Zero();
  World world(options, Surroundings());
  std::vector<BodyState> states(2);
  states[1].to_world.position = Vec3(0.15, 0, 0);
  states[1].velocity = Vec3(0.1, 0, 0);
  const Body body = box({0.1, 0.1, 0.1}, 4);
  ASSERT_TRUE(world.add(std::vector{body, body}, states, {}).ok());
  for (int step = 0; step < 240; ++step) world.step();
  EXPECT_LT(world.state(0).to_world.position.norm(), 1e-9);
  EXPECT_LT((world.state(1).to_world.position - Vec3(0.25, 0, 0)).norm(), 1e-9);
}

// Beyond its limit the hinge is a spring: half an oscillation there takes pi sqrt(I / k), and goes
// as far as spin sqrt(I / k); it comes back as fast as it went.
TEST(RagdollLaws, ASoftLimitIsASpring) {
  for (const double stiffness : {50.0, 400.0}) {
    WorldOptions options;
    options.gravity = Vec3::Zero();
    World world(options, Surroundings());
    const Body body = box({0.05, 0.2, 0.05}, 4);
    Joint joint = hinge_in_origin(0.3);
    joint.range = {-1, 0};
    joint.soft = true;
    joint.stiffness = stiffness;
    const double spin = 2, root = std::sqrt(inertia(body, 0.3) / stiffness);
    ASSERT_TRUE(
        world.add(std::vector{body}, std::vector{hanging(0.3, 0, spin)}, std::vector{joint}).ok());
    double largest = 0, time = 0, before = 0;
    for (int step = 1; step < 2400 && time == 0; ++step) {
      world.step();
      const double now = angle_of(world);
      largest = std::max(largest, now);
      if (now <= 0) time = (step - now / (now - before)) * World::kStep;
      before = now;
    }
    EXPECT_NEAR(largest, spin * root, 0.01 * spin * root);
    EXPECT_NEAR(time, kPi * root, 0.01 * kPi * root);
    EXPECT_NEAR(world.state(0).spin.z(), -spin, 0.01 * spin);
  }
}

// With damping d the oscillation dies by exp(-d t / 2 I).
TEST(RagdollLaws, ASoftLimitDampsAsItSays) {
  WorldOptions options;
  options.gravity = Vec3::Zero();
  World world(options, Surroundings());
  const Body body = box({0.05, 0.2, 0.05}, 4);
  const double whole = inertia(body, 0.3), stiffness = 200, damping = 2;
  Joint joint = hinge_in_origin(0.3);
  joint.range = {-1, 0};
  joint.soft = true;
  joint.stiffness = stiffness;
  joint.damping = damping;
  ASSERT_TRUE(
      world.add(std::vector{body}, std::vector{hanging(0.3, 0, 2)}, std::vector{joint}).ok());
  // The largest angle comes at t = atan(w / g) / w.
  const double decay = damping / (2 * whole);
  const double pulse = std::sqrt(stiffness / whole - decay * decay);
  const double moment = std::atan(pulse / decay) / pulse;
  const double expected = 2 / pulse * std::exp(-decay * moment) * std::sin(pulse * moment);
  double largest = 0;
  for (int step = 0; step < 240; ++step) {
    world.step();
    largest = std::max(largest, angle_of(world));
  }
  EXPECT_NEAR(largest, expected, 0.01 * expected);
}

// Two triangles that rise along +x by `angle`.
Surroundings slope(double angle) {
  Surroundings ground;
  const double far = 2, up = far * std::tan(angle);
  const Vec3 a(-far, -up, -far), b(-far, -up, far), c(far, up, far), d(far, up, -far);
  ground.triangles = {{a, b, c}, {a, c, d}};
  return ground;
}

// How far down a slope a box has gone in a second, from rest.
double slid(double angle, double friction, bool level_and_tilted_gravity) {
  WorldOptions options;
  options.friction = friction;
  const Quat tilt = from_rotation_vector(Vec3(0, 0, angle));
  Surroundings ground = slope(angle);
  BodyState state;
  state.to_world = {tilt * Vec3(0, 0.1, 0), tilt};
  if (level_and_tilted_gravity) {
    options.gravity = tilt.conjugate() * options.gravity;
    ground = {.level = true, .triangles = {}};
    state.to_world = {Vec3(0, 0.1, 0), Quat::Identity()};
  }
  World world(options, ground);
  EXPECT_TRUE(world.add(std::vector{box({0.2, 0.1, 0.2}, 5)}, std::vector{state}, {}).ok());
  for (int step = 0; step < 240; ++step) world.step();
  return (world.state(0).to_world.position - state.to_world.position).norm();
}

// s = g (sin a - mu cos a) t^2 / 2 above the angle of friction, 0 below it.
TEST(RagdollLaws, ABoxSlidesAboveTheAngleOfFrictionAlone) {
  for (const double friction : {0.3, 0.7}) {
    const double critical = std::atan(friction);
    for (const bool level : {false, true}) {
      EXPECT_LT(slid(critical - 0.01, friction, level), level ? 0.002 : 0.01) << friction << level;
      const double angle = critical + 0.15;
      const double expected = 0.5 * kGravity * (std::sin(angle) - friction * std::cos(angle));
      // Points of contact with triangles are in single precision and come and go.
      EXPECT_NEAR(slid(angle, friction, level), expected, (level ? 0.01 : 0.025) * expected)
          << friction << level;
    }
  }
}

// A motor's spring gives way until it holds the weight: k (target - angle) = m g l sin(angle).
// Gains far beyond what an explicit step could follow must not shake it.
TEST(RagdollLaws, AMotorHoldsAWeightWhateverItsGains) {
  for (const double stiffness : {100.0, 1e3, 1e6}) {
    World world(WorldOptions{}, Surroundings{});
    const Body body = box({0.05, 0.2, 0.05}, 4);
    Joint joint = hinge_in_origin(0.3);
    joint.motor = 1e4;
    joint.motor_stiffness = stiffness;
    joint.motor_damping = 0.1 * stiffness;
    const double wanted = 1;
    joint.target = from_rotation_vector(Vec3(wanted, 0, 0));
    ASSERT_TRUE(
        world.add(std::vector{body}, std::vector{hanging(0.3, 0, 0)}, std::vector{joint}).ok());
    for (int step = 0; step < 240 * 4; ++step) world.step();
    const double angle = angle_of(world);
    const double weight = body.mass * kGravity * 0.3 * std::sin(angle);
    EXPECT_NEAR(stiffness * (wanted - angle), weight, 0.01 * weight) << stiffness;
    EXPECT_LT(world.state(0).spin.norm(), 1e-4) << stiffness;
  }
}

// Four links of unlike masses, tied by joints of three kinds, thrown and turning.
struct Chain {
  std::vector<Body> bodies;
  std::vector<BodyState> states;
  std::vector<Joint> joints;
};
Chain make_chain() {
  Chain chain;
  const std::array<double, 4> masses = {8, 1, 4, 0.5};
  const std::array<JointKind, 3> kinds = {JointKind::spherical, JointKind::revolute,
                                          JointKind::six_dof};
  const Vec3 spin(3, -2, 4), velocity(1, 6, -0.5);
  for (std::size_t i = 0; i < masses.size(); ++i) {
    chain.bodies.push_back(box({0.05, 0.15, 0.08}, masses[i]));
    BodyState state;
    state.to_world.position = Vec3(0, -0.4 * static_cast<double>(i), 0);
    state.spin = spin;
    state.velocity = velocity + spin.cross(state.to_world.position);
    chain.states.push_back(state);
    if (i == 0) continue;
    Joint joint;
    joint.kind = kinds[i - 1];
    joint.parent = static_cast<int>(i) - 1;
    joint.child = static_cast<int>(i);
    joint.in_parent.position = Vec3(0, -0.2, 0);
    joint.in_child.position = Vec3(0, 0.2, 0);
    joint.slide.fill({0, 0});
    chain.joints.push_back(joint);
  }
  return chain;
}

struct Momentum {
  Vec3 centre = Vec3::Zero(), angular = Vec3::Zero();
};
Momentum momentum(const Chain& chain, const World& world) {
  Momentum sum;
  double mass = 0;
  Vec3 linear = Vec3::Zero(), about_origin = Vec3::Zero();
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    const Body& body = chain.bodies[i];
    const BodyState state = world.state(static_cast<int>(i));
    const Vec3 size = 2 * body.shape.half, square = size.cwiseProduct(size);
    const Vec3 moments =
        body.mass / 12 *
        Vec3(square.y() + square.z(), square.x() + square.z(), square.x() + square.y());
    const Quat& turn = state.to_world.orientation;
    mass += body.mass;
    sum.centre += body.mass * state.to_world.position;
    linear += body.mass * state.velocity;
    about_origin += body.mass * state.to_world.position.cross(state.velocity) +
                    turn * Vec3(moments.cwiseProduct(turn.conjugate() * state.spin));
  }
  sum.centre /= mass;
  sum.angular = about_origin - sum.centre.cross(linear);
  return sum;
}

// Joints that pushed at the world, or leaked, would bend the path or slow the turning.
TEST(RagdollLaws, AChainInFreeFallKeepsItsMomenta) {
  const Chain chain = make_chain();
  World world(WorldOptions{}, Surroundings{});
  ASSERT_TRUE(world.add(chain.bodies, chain.states, chain.joints).ok());
  const Momentum begin = momentum(chain, world);
  Vec3 velocity = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    velocity += chain.bodies[i].mass * chain.states[i].velocity;
    mass += chain.bodies[i].mass;
  }
  velocity /= mass;
  for (int step = 1; step <= 480; ++step) {
    world.step();
    const double t = step * World::kStep;
    const Momentum now = momentum(chain, world);
    const Vec3 expected = begin.centre + velocity * t + 0.5 * t * t * Vec3(0, -kGravity, 0);
    const double path = velocity.norm() * t + 0.5 * kGravity * t * t;
    ASSERT_LT((now.centre - expected).norm(), 0.001 * path + 1e-5) << t;
    ASSERT_LT((now.angular - begin.angular).norm(), 0.01 * begin.angular.norm()) << t;
    ASSERT_LT(world.measures().joint_gap, 1e-4) << t;
  }
}

}  // namespace
}  // namespace krok::ragdoll
