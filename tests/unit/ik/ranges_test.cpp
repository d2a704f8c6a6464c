// If these fail, limits learnt from captures shut out what the captures do, or published ranges
// depend on how a skeleton happens to orient its joints or in which pose it is stored.

#include <gtest/gtest.h>

#include <cmath>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "ik/limits.h"
#include "math/quaternion.h"
#include "retarget/stance.h"
#include "samples/generator/walk.h"
#include "support/test_scenes.h"

namespace krok::ik {
namespace {

double excess_in(const Clip& clip, const Limits& limits, int joint, int frame) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(frame, pose);
  const Quat& parent = pose[at(clip.skeleton.parents[at(joint)])].orientation;
  return excess(limits[at(joint)], parent.conjugate() * pose[at(joint)].orientation);
}

double largest_excess(const Clip& clip, const Limits& limits) {
  double largest = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 1; j < clip.joint_count(); ++j) {
      largest = std::max(largest, excess_in(clip, limits, j, f));
    }
  }
  return largest;
}

Clip walk() {
  samples::WalkOptions options;
  options.steps = 4;
  options.rate = 30;
  return samples::make_walk(options)->clip;
}

TEST(LearntLimits, HoldEveryPoseTheyWereLearntFromAndNotMuchMore) {
  for (const Clip& clip :
       {walk(), krok::test::swinging_clip(krok::test::turned_human(), 100, 30)}) {
    const Clip* one = &clip;
    const auto limits = learn_limits(clip.skeleton, {&one, 1});
    ASSERT_TRUE(limits.ok());
    EXPECT_TRUE(check(*limits, clip.joint_count()).ok());
    EXPECT_LE(largest_excess(clip, *limits), 1e-6);
    // A joint turned by a radian beyond its widest pose is outside.
    int shut = 0, limited = 0;
    for (int j = 1; j < clip.joint_count(); ++j) {
      const JointLimit& limit = (*limits)[at(j)];
      if (limit.kind != JointLimit::Kind::cone && limit.kind != JointLimit::Kind::hinge) continue;
      ++limited;
      const Quat wide = compose(limit, limit.max_twist + 1, {0, 0});
      shut += excess(limit, wide) > 0.9 ? 1 : 0;
    }
    EXPECT_GT(limited, 10);
    EXPECT_EQ(shut, limited);
  }
}

TEST(LearntLimits, KnowHingesAndJointsThatNeverTurn) {
  Clip clip = krok::test::swinging_human(60);
  std::vector<Transform> local(clip.skeleton.names.size()), world(local.size());
  const int knee = clip.skeleton.find("LeftLeg"), neck = clip.skeleton.find("Neck");
  for (int f = 0; f < 60; ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) local[at(j)] = clip.skeleton.reference_local(j);
    local[at(knee)].orientation = Quat(Eigen::AngleAxisd(0.02 * f, Vec3::UnitX()));
    local_to_world(clip.skeleton.parents, local, world);
    clip.set_pose(f, world);
  }
  const Clip* one = &clip;
  const auto limits = learn_limits(clip.skeleton, {&one, 1}, {.margin = 0});
  ASSERT_TRUE(limits.ok());
  const JointLimit& hinge = (*limits)[at(knee)];
  EXPECT_EQ(hinge.kind, JointLimit::Kind::hinge);
  EXPECT_NEAR(std::abs(hinge.axis.x()), 1, 1e-5);
  EXPECT_NEAR(hinge.max_twist - hinge.min_twist, 0.02 * 59, 1e-4);
  EXPECT_EQ((*limits)[at(neck)].kind, JointLimit::Kind::locked);
  const auto wider = learn_limits(clip.skeleton, {&one, 1}, {.margin = 0.1});
  ASSERT_TRUE(wider.ok());
  EXPECT_NEAR((*wider)[at(knee)].max_twist, hinge.max_twist + 0.1, 1e-9);
}

TEST(LearntLimits, OtherSkeletonsAndEmptyMotionsAreRefused) {
  const Clip clip = krok::test::swinging_human(10);
  Clip renamed = clip, turned = clip, empty = clip;
  renamed.skeleton.names[3] = "Other";
  turned.skeleton = krok::test::turned_human();
  empty.resize(0);
  for (const auto& [other, code] :
       {std::pair(&renamed, "limits-skeleton"), std::pair(&turned, "limits-skeleton"),
        std::pair(&empty, "limits-empty")}) {
    const auto limits = learn_limits(clip.skeleton, {&other, 1});
    ASSERT_FALSE(limits.ok());
    EXPECT_EQ(limits.error().code, code);
  }
}

// A person who walks stays within what people can do.
TEST(AnatomicalLimits, HoldAWalk) {
  const Clip clip = walk();
  const Limits limits = anatomical_limits(clip.skeleton, find_roles(clip.skeleton));
  EXPECT_TRUE(check(limits, clip.joint_count()).ok());
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 1; j < clip.joint_count(); ++j) {
      EXPECT_LE(excess_in(clip, limits, j, f), 2 * kRadiansPerDegree)
          << clip.skeleton.names[at(j)] << " in frame " << f;
    }
  }
}

// Exporters whose bones all lie along one axis store a leg that points up beside the trunk. Without
// a pose that stands the hip's twist of such a leg would be measured from half a turn away.
TEST(AnatomicalLimits, HoldAWalkWhoseReferencePoseHasALegTurnedUp) {
  Clip clip = walk();
  const RoleMap roles = find_roles(clip.skeleton);
  const std::vector<Transform> standing = clip.skeleton.reference;
  const int thigh = roles.joint(Role::right_upper_leg);
  const Transform& at_hip = standing[at(thigh)];
  const Quat turn = from_rotation_vector(Vec3(0.3, 0, 3.0));
  std::vector<char> leg(standing.size(), 0);
  for (int j = thigh; j < clip.joint_count(); ++j) {
    leg[at(j)] = j == thigh || leg[at(clip.skeleton.parents[at(j)])] != 0 ? 1 : 0;
    if (leg[at(j)] == 0) continue;
    Transform& joint = clip.skeleton.reference[at(j)];
    joint = {at_hip.position + turn * (joint.position - at_hip.position), turn * joint.orientation};
  }
  const Skeleton neutral = retarget::neutral_skeleton(clip, roles);
  const Limits limits = anatomical_limits(neutral, roles);
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 1; j < clip.joint_count(); ++j) {
      // The roll of arms is as in the frame that was chosen.
      EXPECT_LE(excess_in(clip, limits, j, f), 5 * kRadiansPerDegree)
          << clip.skeleton.names[at(j)] << " in frame " << f;
    }
  }
  // A reference pose that only lies is as good as one that stands, and is kept.
  const Transform lie{Vec3(1, 0, 0), from_rotation_vector(Vec3(-kPi / 2, 0, 0))};
  clip.skeleton.reference = standing;
  for (Transform& joint : clip.skeleton.reference) joint = lie * joint;
  EXPECT_EQ(retarget::neutral_skeleton(clip, roles).reference[3].position,
            clip.skeleton.reference[3].position);
}

// Turns of one joint of the reference pose about the body's axes, in degrees, and by how much they
// are beyond the range.
TEST(AnatomicalLimits, AreTheRangesOfTheBody) {
  struct Case {
    const char* joint;
    Vec3 axis;
    double degrees, beyond;
  };
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const Case cases[] = {
      {"LeftLeg", x, 134, 0},     {"LeftLeg", x, 145, 10},     {"LeftLeg", -x, 30, 20},
      {"RightLeg", x, 134, 0},    {"RightLeg", -x, 30, 20},    {"LeftUpLeg", -x, 119, 0},
      {"LeftUpLeg", x, 50, 20},   {"LeftUpLeg", z, 44, 0},     {"LeftUpLeg", -z, 45, 15},
      {"RightUpLeg", -z, 44, 0},  {"RightUpLeg", z, 45, 15},   {"LeftForeArm", -y, 149, 0},
      {"LeftForeArm", y, 30, 20}, {"RightForeArm", y, 149, 0}, {"RightForeArm", -y, 30, 20},
      {"Head", x, 22, 0},         {"Head", y, 29, 0},          {"Head", y, 60, 30}};
  for (const bool turned : {false, true}) {
    for (const bool lying : {false, true}) {
      Skeleton skeleton = turned ? krok::test::turned_human() : krok::test::human_skeleton();
      const Transform move{Vec3(1, 2, 3), lying ? from_rotation_vector(Vec3(1.2, -0.7, 0.9))
                                                : Quat(Quat::Identity())};
      for (Transform& joint : skeleton.reference) joint = move * joint;
      RoleMap roles = find_roles(krok::test::human_skeleton());
      const Limits limits = anatomical_limits(skeleton, roles);
      for (const Case& one : cases) {
        const int j = skeleton.find(one.joint);
        const Vec3 axis = move.orientation * one.axis;
        const Quat world = Quat(Eigen::AngleAxisd(one.degrees * kRadiansPerDegree, axis)) *
                           skeleton.reference[at(j)].orientation;
        const Quat local =
            skeleton.reference[at(skeleton.parents[at(j)])].orientation.conjugate() * world;
        EXPECT_NEAR(excess(limits[at(j)], local) / kRadiansPerDegree, one.beyond, 1.0)
            << one.joint << " " << one.axis.transpose() << " " << one.degrees;
      }
    }
  }
}

TEST(AnatomicalLimits, LetAnArmHangAndRise) {
  const Skeleton skeleton = krok::test::human_skeleton();
  const Limits limits = anatomical_limits(skeleton, find_roles(skeleton));
  for (const bool left : {true, false}) {
    const int arm = skeleton.find(left ? "LeftArm" : "RightArm");
    const double side = left ? 1 : -1;
    const Vec3 now(side, 0, 0);
    for (const Vec3& allowed : {Vec3(0, -1, 0), Vec3(side, 0, 0), Vec3(0, 0, 1),
                                Vec3(0.1 * side, 0.9, 0.3), Vec3(0.3 * side, -1, -0.4)}) {
      EXPECT_EQ(excess(limits[at(arm)], shortest_arc(now, allowed)), 0)
          << side << " " << allowed.transpose();
    }
    EXPECT_GT(excess(limits[at(arm)], shortest_arc(now, Vec3(-0.5 * side, 0, -1))), 0.2);
  }
}

TEST(AnatomicalLimits, FreeWhereTheBodyIsNotKnown) {
  Skeleton chain;
  for (int j = 0; j < 5; ++j) chain.add("n" + std::to_string(j), j - 1, {Vec3(0, j, 0), {}});
  for (const JointLimit& limit : anatomical_limits(chain, find_roles(chain))) {
    EXPECT_EQ(limit.kind, JointLimit::Kind::free);
  }
}

TEST(BodyMasses, AddUpToABodyWhoseCentreIsInThePelvis) {
  const Skeleton skeleton = krok::test::turned_human();
  const BodyMasses body = body_masses(skeleton, find_roles(skeleton));
  double mass = 0;
  Vec3 centre = Vec3::Zero();
  for (std::size_t j = 0; j < body.masses.size(); ++j) {
    mass += body.masses[j];
    centre += body.masses[j] * (skeleton.reference[j] * body.centres[j]);
  }
  EXPECT_NEAR(mass, 73, 0.2);
  centre /= mass;
  EXPECT_LT(std::abs(centre.x()), 1e-6);
  // 0.55 to 0.58 of the stature for arms at the sides; a little higher with arms raised.
  EXPECT_NEAR(centre.y() / 1.75, 0.58, 0.04);
}

}  // namespace
}  // namespace krok::ik
