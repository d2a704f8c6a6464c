// If these fail, characters explode, come apart, sink into the ground or never lie still; or the
// same fall is another one the next time.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "math/quaternion.h"
#include "motion/sample.h"
#include "ragdoll/simulate.h"
#include "samples/generator/walk.h"
#include "support/human_skeleton.h"

namespace krok::ragdoll {
namespace {

struct Walker {
  Clip clip;
  RoleMap roles;
  std::vector<Body> bodies;
  ik::Limits limits;
};

Walker make_walker() {
  samples::WalkOptions options;
  options.steps = 6;
  options.rate = 60;
  Walker walker;
  walker.clip = samples::make_walk(options)->clip;
  walker.roles = find_roles(walker.clip.skeleton);
  walker.bodies = *make_bodies(walker.clip.skeleton, walker.roles);
  walker.limits = ik::anatomical_limits(walker.clip.skeleton, walker.roles);
  return walker;
}

FallOptions on_the_ground(double begin, double duration) {
  FallOptions options;
  options.at = begin;
  options.duration = duration;
  options.surroundings.level = true;
  return options;
}

Fall fall_of(const Walker& walker, const FallOptions& options) {
  auto fall = simulate_fall(walker.clip, walker.roles, walker.bodies, walker.limits, options);
  EXPECT_TRUE(fall.ok()) << fall.error().message;
  return std::move(*fall);
}

// The mean of [0, 1), the same on every machine.
double share(std::mt19937& random) {
  return random() / 4294967296.0;
}

TEST(RagdollFalls, RandomPushesEndInRest) {
  const Walker walker = make_walker();
  std::mt19937 random(7);
  constexpr int kFalls = 100;
  int at_rest = 0, joined = 0, above = 0, within = 0;
  double gap = 0, depth = 0, excess = 0;
  for (int i = 0; i < kFalls; ++i) {
    FallOptions options = on_the_ground(walker.clip.duration() * share(random), 5);
    Push push;
    push.body = static_cast<int>(share(random) * static_cast<double>(walker.bodies.size()));
    const double mass = walker.bodies[at(push.body)].mass;
    const double angle = 2 * kPi * share(random);
    push.impulse = mass * (1 + 7 * share(random)) * Vec3(std::cos(angle), 0.2, std::sin(angle));
    push.time = options.at;
    options.pushes = {push};
    const Fall fall = fall_of(walker, options);
    ASSERT_TRUE(check(fall.clip).ok()) << i;
    at_rest += fall.rest >= 0 ? 1 : 0;
    joined += fall.largest.joint_gap < 1e-6 ? 1 : 0;
    above += fall.largest.penetration < 0.005 ? 1 : 0;
    within += fall.largest.limit_excess < kRadiansPerDegree ? 1 : 0;
    gap = std::max(gap, fall.largest.joint_gap);
    depth = std::max(depth, fall.largest.penetration);
    excess = std::max(excess, fall.largest.limit_excess);
    // Nothing hovers: at the end some joint is near the ground, and none far above it.
    double top = 0;
    for (const Vec3f& place : fall.clip.frame_positions(fall.clip.frame_count() - 1)) {
      top = std::max(top, static_cast<double>(place.y()));
    }
    EXPECT_LT(top, 1.0) << i;
  }
  EXPECT_GE(at_rest, 99) << at_rest;
  EXPECT_EQ(joined, kFalls) << gap;
  EXPECT_EQ(above, kFalls) << depth;
  EXPECT_EQ(within, kFalls) << excess / kRadiansPerDegree;
}

// Two worlds at once would differ if one saw the other, or anything depended on addresses.
TEST(RagdollFalls, TheSameFallHasTheSameBytes) {
  const Walker walker = make_walker();
  FallOptions options = on_the_ground(1.2, 1.5);
  options.pushes = {{2, Vec3(80, 0, 30), 1.2}, {0, Vec3(0, 0, -40), 1.6}};
  const Fall first = fall_of(walker, options);
  for (int i = 0; i < 3; ++i) {
    const Fall again = fall_of(walker, options);
    ASSERT_EQ(again.clip.positions, first.clip.positions);
    for (std::size_t k = 0; k < first.clip.orientations.size(); ++k) {
      ASSERT_EQ(again.clip.orientations[k].coeffs(), first.clip.orientations[k].coeffs());
    }
  }
}

// The fall begins in the motion's pose with its speeds; what lies before it is untouched, and the
// bones keep their lengths.
TEST(RagdollFalls, MotionAndFallMeetWithoutAJump) {
  const Walker walker = make_walker();
  const double begin = 1.2;
  const FallOptions options = on_the_ground(begin, 2);
  const Fall fall = fall_of(walker, options);
  const int first = fall.first_frame;
  ASSERT_EQ(first, 72);
  EXPECT_EQ(fall.clip.frame_count(), 72 + 120 + 1);
  const int hips = walker.bodies.front().joint;
  for (int frame = 0; frame < first; ++frame) {
    for (int j = 0; j < walker.clip.joint_count(); ++j) {
      ASSERT_EQ(fall.clip.frame_positions(frame)[at(j)], walker.clip.frame_positions(frame)[at(j)]);
    }
  }
  for (int j = 0; j < walker.clip.joint_count(); ++j) {
    EXPECT_LT((fall.clip.frame_positions(first)[at(j)] - walker.clip.frame_positions(first)[at(j)])
                  .norm(),
              1e-4f);
  }
  const auto speed = [&](const Clip& clip, int frame) {
    return Vec3f(
        (clip.frame_positions(frame + 1)[at(hips)] - clip.frame_positions(frame)[at(hips)]) *
        static_cast<float>(clip.rate));
  };
  const Vec3f jump = speed(fall.clip, first) - speed(walker.clip, first - 1);
  EXPECT_LT(std::hypot(jump.x(), jump.z()), 0.15f);
  for (int j = 1; j < walker.clip.joint_count(); ++j) {
    const auto length = [&](int frame) {
      const auto places = fall.clip.frame_positions(frame);
      return (places[at(j)] - places[at(walker.clip.skeleton.parents[at(j)])]).norm();
    };
    EXPECT_NEAR(length(fall.clip.frame_count() - 1), length(first), 1e-5f);
  }
}

// Masses that are lost, or shapes on the wrong side, would make characters that fall like no body.
TEST(RagdollBodies, AHumanHasSixteenBodiesOfItsMassSymmetrically) {
  const Skeleton skeleton = test::human_skeleton();
  const auto bodies = make_bodies(skeleton, find_roles(skeleton), {.mass = 80});
  ASSERT_TRUE(bodies.ok());
  ASSERT_EQ(bodies->size(), 16u);
  double mass = 0;
  const auto named = [&](const std::string& name) {
    for (const Body& body : *bodies) {
      if (body.name == name) return body;
    }
    ADD_FAILURE() << name;
    return Body();
  };
  for (const Body& body : *bodies) mass += body.mass;
  EXPECT_NEAR(mass, 80, 1e-9);
  EXPECT_NEAR(named("left_thigh").mass, 80 * 0.1416, 0.1);
  for (const char* part : {"_upper_arm", "_lower_arm", "_hand", "_thigh", "_shank", "_foot"}) {
    const Body left = named(std::string("left") + part), right = named(std::string("right") + part);
    EXPECT_NEAR(left.mass, right.mass, 1e-9) << part;
    const Vec3 a = skeleton.reference[at(left.joint)] * left.to_joint.position;
    const Vec3 b = skeleton.reference[at(right.joint)] * right.to_joint.position;
    EXPECT_LT((a - Vec3(-b.x(), b.y(), b.z())).norm(), 1e-6) << part;
  }
}

// What the chart in samples/fall shows: hard ranges stop the feet that are bent over on landing,
// soft ones give way by some degrees and push back. Without it --soft would do nothing, or let
// joints turn as they like.
TEST(RagdollFalls, SoftRangesGiveWayWhereHardOnesStop) {
  const Walker walker = make_walker();
  const auto largest_excess = [&](bool soft) {
    FallOptions options = on_the_ground(1.2, 3);
    options.joints.soft = soft;
    Push push;
    push.impulse = Vec3(40, 0, -160);
    push.time = 1.2;
    options.pushes = {push};
    const Fall fall = fall_of(walker, options);
    double largest = 0;
    std::vector<Transform> pose(walker.clip.skeleton.names.size()), local(pose.size());
    for (int f = fall.first_frame; f < fall.clip.frame_count(); ++f) {
      fall.clip.get_pose(f, pose);
      world_to_local(walker.clip.skeleton.parents, pose, local);
      for (const Role role : {Role::left_foot, Role::right_foot}) {
        const auto foot = at(walker.roles.joint(role));
        largest = std::max(largest, ik::excess(walker.limits[foot], local[foot].orientation));
      }
    }
    return largest / kRadiansPerDegree;
  };
  EXPECT_LT(largest_excess(false), 1);
  const double soft = largest_excess(true);
  EXPECT_GT(soft, 2);
  EXPECT_LT(soft, 30);
}

// A file exporter's choice of axes must not change the body.
TEST(RagdollBodies, AreTheSameForALyingReferencePose) {
  Skeleton skeleton = test::human_skeleton();
  const auto upright = make_bodies(skeleton, find_roles(skeleton));
  const Transform turn{Vec3(3, 1, -2), from_rotation_vector(Vec3(-kPi / 2, 0.4, 0))};
  for (Transform& joint : skeleton.reference) joint = turn * joint;
  const auto lying = make_bodies(skeleton, find_roles(skeleton));
  ASSERT_TRUE(upright.ok() && lying.ok());
  ASSERT_EQ(upright->size(), lying->size());
  for (std::size_t b = 0; b < upright->size(); ++b) {
    const Body &a = (*upright)[b], &c = (*lying)[b];
    EXPECT_LT((a.to_joint.position - c.to_joint.position).norm(), 1e-9) << a.name;
    EXPECT_LT(angle_between(a.to_joint.orientation, c.to_joint.orientation), 1e-9) << a.name;
    EXPECT_NEAR(volume(a.shape), volume(c.shape), 1e-12) << a.name;
  }
}

TEST(RagdollBodies, RefuseWhatHasNoExtentAndTimesOutsideTheMotion) {
  Skeleton two;
  two.add("a", -1, {});
  two.add("b", 0, {});
  EXPECT_EQ(make_bodies(two, find_roles(two)).error().code, "ragdoll-size");
  const Walker walker = make_walker();
  EXPECT_EQ(make_bodies(walker.clip.skeleton, walker.roles, {.mass = 0}).error().code,
            "ragdoll-size");
  const auto late =
      simulate_fall(walker.clip, walker.roles, walker.bodies, walker.limits, on_the_ground(99, 1));
  EXPECT_EQ(late.error().code, "ragdoll-time");
  FallOptions pushed = on_the_ground(1, 1);
  pushed.pushes = {{99, Vec3::Zero(), 1}};
  const auto none = simulate_fall(walker.clip, walker.roles, walker.bodies, walker.limits, pushed);
  EXPECT_EQ(none.error().code, "ragdoll-value");
}

}  // namespace
}  // namespace krok::ragdoll
