// Skeletons that are no humanoids. If these fail, animals and machines have no ragdoll, one whose
// bodies are not at its bones, or one that comes apart or never rests.

#include "ragdoll/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"
#include "ragdoll/simulate.h"
#include "roles/roles.h"
#include "support/human_skeleton.h"

namespace krok::ragdoll {
namespace {

struct Creature {
  const char* name;
  double size;  // metres
  Skeleton skeleton;
};

int add_joint(Skeleton& skeleton, int parent, const Vec3& offset) {
  const Vec3 place =
      parent < 0 ? offset
                 : Vec3(skeleton.reference[static_cast<std::size_t>(parent)].position + offset);
  // Joints have axes of their own, which nothing may depend on.
  const double turn = 0.7 * static_cast<double>(skeleton.joint_count());
  skeleton.add("j" + std::to_string(skeleton.joint_count()), parent,
               {place, from_rotation_vector(turn * Vec3(0.48, 0.6, 0.64))});
  return skeleton.joint_count() - 1;
}

int add_chain(Skeleton& skeleton, int parent, int count, const Vec3& step) {
  for (int i = 0; i < count; ++i) parent = add_joint(skeleton, parent, step);
  return parent;
}

Skeleton quadruped(double size) {
  Skeleton skeleton;
  const int pelvis = add_joint(skeleton, -1, size * Vec3(0, 0.6, 0));
  const int chest = add_chain(skeleton, pelvis, 2, size * Vec3(0, 0, 0.25));
  add_chain(skeleton, chest, 3, size * Vec3(0, 0.08, 0.15));
  add_chain(skeleton, pelvis, 4, size * Vec3(0, -0.02, -0.1));
  for (const double side : {-1.0, 1.0}) {
    for (const int above : {pelvis, chest}) {
      const int hip = add_joint(skeleton, above, size * Vec3(0.08 * side, -0.05, 0));
      add_chain(skeleton, hip, 3, size * Vec3(0, -0.17, 0.01));
    }
  }
  return skeleton;
}

Skeleton snake() {
  Skeleton skeleton;
  add_chain(skeleton, add_joint(skeleton, -1, Vec3(0, 0.3, 0)), 20, Vec3(0, 0, -0.08));
  return skeleton;
}

Skeleton many_legs(int legs, int joints, const Vec3& body, double reach) {
  Skeleton skeleton;
  const int root = add_joint(skeleton, -1, Vec3(0, 0.5, 0));
  add_joint(skeleton, root, body);
  for (int leg = 0; leg < legs; ++leg) {
    const double angle = 2 * kPi * (leg + 0.3) / legs;
    add_chain(skeleton, root, joints,
              reach / joints * Vec3(std::cos(angle), -0.3, std::sin(angle)));
  }
  return skeleton;
}

Skeleton hand() {
  Skeleton skeleton;
  const int wrist = add_joint(skeleton, -1, Vec3(0, 0.4, 0));
  for (int finger = 0; finger < 5; ++finger) {
    const int knuckle = add_joint(skeleton, wrist, Vec3(0.02 * (finger - 2), 0, 0.09));
    add_chain(skeleton, knuckle, 3, Vec3(0, 0, 0.03));
  }
  return skeleton;
}

std::vector<Creature> creatures() {
  return {{"mouse", 0.1, quadruped(0.1)},
          {"fox", 0.6, quadruped(0.6)},
          {"horse", 2, quadruped(2)},
          {"snake", 1.6, snake()},
          {"hand", 0.2, hand()},
          {"spider", 1, many_legs(8, 4, Vec3(0, 0, -0.12), 0.5)},
          {"octopus", 1, many_legs(8, 8, Vec3(0, 0.25, 0), 0.6)},
          {"robot", 2, many_legs(4, 3, Vec3(0, 0.4, 0), 1)}};
}

Clip standing(const Skeleton& skeleton) {
  Clip clip;
  clip.skeleton = skeleton;
  clip.rate = 30;
  clip.resize(2);
  for (int f = 0; f < 2; ++f) clip.set_pose(f, skeleton.reference);
  return clip;
}

// Rigs whose hips hang on the trunk: legs fell and left the trunk in the air.
TEST(BoneBodies, WhatCarriesTheHipsFallsWithThem) {
  Skeleton skeleton;
  const int torso = add_chain(skeleton, add_joint(skeleton, -1, Vec3(0, 0, 0)), 1, {0, 0.8, 0});
  const int hips = add_joint(skeleton, torso, Vec3(0, -0.1, 0));
  add_chain(skeleton, torso, 2, Vec3(0, 0.3, 0));
  for (const double side : {-0.2, 0.2}) {
    add_chain(skeleton, hips, 2, Vec3(0.2 * side, -0.3, 0));
    add_chain(skeleton, torso, 3, Vec3(side, 0, 0));
  }
  const std::vector<Body> bodies = bone_bodies(skeleton, hips);
  ASSERT_FALSE(bodies.empty());
  EXPECT_EQ(bodies.front().joint, torso);
  EXPECT_GT(bodies.size(), 8U);
  EXPECT_EQ(std::ranges::count(bodies, -1, &Body::parent), 1);
}

TEST(BoneBodies, ACapsuleForEachBoneAtItsJoints) {
  for (const Creature& creature : creatures()) {
    SCOPED_TRACE(creature.name);
    const Skeleton& skeleton = creature.skeleton;
    const RoleMap roles = find_roles(skeleton);
    ASSERT_FALSE(roles.humanoid);
    const auto bodies = make_bodies(skeleton, roles);
    ASSERT_TRUE(bodies.ok());
    EXPECT_EQ(bodies->size(), skeleton.names.size());
    for (std::size_t b = 0; b < bodies->size(); ++b) {
      const Body& body = (*bodies)[b];
      EXPECT_LT(body.parent, static_cast<int>(b));
      EXPECT_EQ(body.parent < 0, b == 0);
      // One end is the joint.
      const Transform to_world =
          skeleton.reference[static_cast<std::size_t>(body.joint)] * body.to_joint;
      const Vec3 end = to_world * Vec3(0, -body.shape.half_length - body.shape.radius, 0);
      const Vec3 joint = skeleton.reference[static_cast<std::size_t>(body.joint)].position;
      EXPECT_LT((end - joint).norm(), 1e-9) << body.name;
      EXPECT_NEAR(body.mass, 1000 * volume(body.shape), 1e-9);
    }
    const auto heavy = make_bodies(skeleton, roles, {.mass = 12});
    double sum = 0;
    for (const Body& body : *heavy) sum += body.mass;
    EXPECT_NEAR(sum, 12, 1e-9);
  }
}

TEST(BoneBodies, FallsRestInFiveSecondsWithoutGaps) {
  for (const Creature& creature : creatures()) {
    SCOPED_TRACE(creature.name);
    const Clip clip = standing(creature.skeleton);
    const RoleMap roles = find_roles(clip.skeleton);
    const auto bodies = make_bodies(clip.skeleton, roles);
    ASSERT_TRUE(bodies.ok());
    FallOptions options;
    options.duration = 6;
    options.surroundings.level = true;
    // A body in exact balance would not fall.
    options.pushes = {{0, Vec3(0.5, 0, 0.2) * bodies->front().mass, 0}};
    const auto fall =
        simulate_fall(clip, roles, *bodies, cone_limits(clip.skeleton, *bodies), options);
    ASSERT_TRUE(fall.ok());
    EXPECT_GE(fall->rest, 0);
    EXPECT_LE(fall->rest, 5);
    EXPECT_LT(std::max(fall->largest.joint_gap, fall->settling.joint_gap), 1e-4);
    EXPECT_LT(fall->largest.limit_excess, 1 * kRadiansPerDegree);
    EXPECT_LT(fall->largest.penetration, 0.005);
    // It lies: the middle of its bodies is lower than it was.
    double before = 0, after = 0;
    for (const Body& body : *bodies) {
      const auto joint = static_cast<std::size_t>(body.joint);
      before += clip.skeleton.reference[joint].position.y();
      after += fall->clip.frame_positions(fall->clip.frame_count() - 1)[joint].y();
    }
    EXPECT_LT(after, 0.6 * before);
  }
}

// A head of 0.8 m on a body of 1.75 m, as cartoons have. Would fail if it kept an adult's size,
// with which it fell half a metre into the ground.
TEST(BonesOfPeople, AHeadIsAsLargeAsItsMesh) {
  Model model;
  model.skeleton = test::human_skeleton();
  const int head = model.skeleton.find("Head");
  const Vec3 middle =
      model.skeleton.reference[static_cast<std::size_t>(head)].position + Vec3(0, 0.35, 0.05);
  for (int i = 0; i < 2000; ++i) {  // even over a sphere, by the golden angle
    const double y = 1 - 2 * (i + 0.5) / 2000, across = std::sqrt(1 - y * y);
    const Vec3 out(across * std::cos(2.39996323 * i), y, across * std::sin(2.39996323 * i));
    model.positions.emplace_back((middle + 0.4 * out).cast<float>());
  }
  model.influences_per_vertex = 1;
  model.influence_joints.assign(model.positions.size(), static_cast<std::uint16_t>(head));
  model.influence_weights.assign(model.positions.size(), 1);
  BodyOptions options;
  options.model = &model;
  const auto bodies = make_bodies(model.skeleton, find_roles(model.skeleton), options);
  ASSERT_TRUE(bodies.ok()) << bodies.error().message;
  EXPECT_GT(covered_share(model, *bodies, 0.03), 0.99);
}

}  // namespace
}  // namespace krok::ragdoll
