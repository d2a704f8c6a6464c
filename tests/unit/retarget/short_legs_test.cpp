// Actors of a toy's proportions: short legs, wide hips, boots with high ankles. If these fail,
// their soles are in the ground, their boots in each other, or knees snap.

#include <gtest/gtest.h>

#include <algorithm>

#include "contacts/legs.h"
#include "contacts/sole_points.h"
#include "motion/local_motion.h"
#include "plant/follow_feet.h"
#include "retarget/foot_points.h"
#include "samples/generator/walk.h"
#include "support/chibi_skeleton.h"
#include "tests/unit/retarget/actors.h"

namespace krok {
namespace {

using namespace test;

constexpr double kAnkle = 0.145, kToes = 0.026;  // metres, of chibi_skeleton() on the ground

samples::Walk walk_of(double stature) {
  samples::WalkOptions options;
  options.steps = 6;
  options.stature = stature;
  auto walk = samples::make_walk(options);
  EXPECT_TRUE(walk.ok());
  return std::move(*walk);
}

int joint_of(const Clip& clip, Role role) {
  return find_roles(clip.skeleton).joint(role);
}

Vec3 place_of(const Clip& clip, int frame, int joint) {
  return clip.frame_positions(frame)[at(joint)].cast<double>();
}

double width_of(const Clip& clip) {
  return (place_of(clip, 0, joint_of(clip, Role::left_upper_leg)) -
          place_of(clip, 0, joint_of(clip, Role::right_upper_leg)))
      .norm();
}

double height_of(const Feet& feet, const Clip& clip, int frame, FootPart part) {
  for (const SolePoint& point : feet.points[0]) {
    if (point.part == part) return (joint_at(clip, frame, point.joint) * point.offset).y();
  }
  return 1e9;
}

// Ankles over 0.16 of the leg were taken for toes that point down: the heel was 85 mm too high.
TEST(ShortLegs, SolesAreBelowHighAnkles) {
  Clip standing = resting(with_other_axes(chibi_skeleton(), 4));
  standing.rate = 30;
  standing.resize(9);
  for (int f = 0; f < 9; ++f) standing.set_pose(f, standing.skeleton.reference);
  const Feet feet = find_feet(standing, find_roles(standing.skeleton));
  EXPECT_NEAR(height_of(feet, standing, 0, FootPart::heel), 0, 1e-6);
  EXPECT_NEAR(height_of(feet, standing, 0, FootPart::ball), kToes, 1e-6);
}

// People on the tips of their toes, or with a reference pose that points them, have no such ankles.
TEST(ShortLegs, ToesThatPointDownAreNoHighAnkles) {
  for (const bool in_reference : {false, true}) {
    Skeleton skeleton = human_skeleton();
    const Quat down = from_rotation_vector(0.9 * Vec3::UnitX());
    Clip clip = resting(skeleton);
    clip.skeleton = posed(posed(skeleton, "LeftFoot", down), "RightFoot", down);
    clip.rate = 30;
    clip.resize(9);
    for (int f = 0; f < 9; ++f) {
      clip.set_pose(f, in_reference ? skeleton.reference : clip.skeleton.reference);
    }
    if (!in_reference) clip.skeleton = skeleton;
    const Feet feet = find_feet(clip, find_roles(clip.skeleton));
    const Vec3 heel = feet.points[0].front().offset;
    EXPECT_LT(heel.norm(), 0.18 * feet.leg_length) << in_reference;
  }
}

// The motion on short legs that are led over level ground, as by krok-retarget --ground.
auto on_short_legs(const Clip& source) {
  const Skeleton target = with_other_axes(chibi_skeleton(), 4);
  const auto copy = transfer(source, target, {.feet = retarget::Feet::free});
  EXPECT_TRUE(copy.ok());
  const GroundBelow level = {[](const Vec3&) { return std::optional<double>(0); },
                             [](const Vec3&) { return Vec3(Vec3::UnitY()); }};
  return follow_feet(source, find_roles(source.skeleton), copy->clip, find_roles(target),
                     copy->report.scale, level);
}

TEST(ShortLegs, StandOnTheGroundThatTheyAreLedOver) {
  const Clip source = walk_of(1.4).clip;
  const auto made = on_short_legs(source);
  ASSERT_TRUE(made.ok()) << made.error().message;
  EXPECT_LT(made->sunk, 0.003);
  for (const Contact& contact : made->contacts) {
    const double height = contact.place.y();
    if (made->clip.skeleton.names[at(contact.joint)].ends_with("Foot")) {
      EXPECT_NEAR(height, kAnkle, 0.01);
    } else {
      EXPECT_NEAR(height, kToes, 0.003);
    }
  }
  EXPECT_GE(made->contacts.size(), 8u);
}

// Feet were scaled by the legs alone: boots of 0.24 m stood 0.04 m apart, and a toy's stance on a
// person's legs was a straddle.
TEST(ShortLegs, FeetAreAsFarFromTheirHipsAsTheSources) {
  const samples::Walk walk = walk_of(1.75);
  const auto onto_toy = transfer(walk.clip, with_other_axes(chibi_skeleton(), 4));
  ASSERT_TRUE(onto_toy.ok());
  Clip toy = onto_toy->clip;
  const auto onto_person = transfer(toy, human_skeleton(1.75));
  ASSERT_TRUE(onto_person.ok());
  for (const auto& [source, made] : {std::pair(&walk.clip, &*onto_toy), {&toy, &*onto_person}}) {
    const Clip& clip = made->clip;
    const double scale = made->report.scale;
    const double wider = 0.5 * (width_of(clip) - scale * width_of(*source));
    ASSERT_GT(std::abs(wider), 0.05);
    for (const std::size_t side : {0, 1}) {
      const Role foot = side == 0 ? Role::left_foot : Role::right_foot;
      const int theirs = joint_of(*source, foot), own = joint_of(clip, foot);
      int stances = 0;
      for (const samples::Contact& heel : walk.feet[side].heel) {
        for (const samples::Contact& toe : walk.feet[side].toe) {
          const double from = std::max(heel.from, toe.from), to = std::min(heel.to, toe.to);
          if (to - from < 0.1) continue;
          ++stances;
          Eigen::AlignedBox3d off;
          for (auto f = static_cast<int>(std::ceil((from + 0.02) * clip.rate));
               f < (to - 0.02) * clip.rate; ++f) {
            off.extend(place_of(clip, f, own) - scale * place_of(*source, f, theirs));
          }
          // To the side, not ahead, and by the same in all of a stance.
          EXPECT_NEAR(off.center().x(), side == 0 ? wider : -wider, 0.1 * std::abs(wider));
          EXPECT_LT(off.sizes().maxCoeff(), 0.008);
        }
      }
      EXPECT_GE(stances, 2);
    }
  }
}

TEST(ShortLegs, HipsAsPeopleHaveThemMoveNoFeet) {
  EXPECT_EQ(beside_for_hips(0.2, 0.12, 0.8), 0);
  EXPECT_EQ(beside_for_hips(0.12, 0.2, 0.8), 0);
  EXPECT_NEAR(beside_for_hips(0.34, 0.08, 0.37), 0.13, 1e-12);
  EXPECT_NEAR(beside_for_hips(0.2, 0.7, 0.8), -0.25, 1e-12);
  EXPECT_EQ(beside_for_hips(0.2, 0.1, 0), 0);
}

// Boots on chibi_skeleton() with other names: boxes that reach 0.11 m behind the ankle, and 0.19 m
// ahead of the toe joint with what follows it.
Model boots_on(const Skeleton& skeleton) {
  Model model;
  model.skeleton = skeleton;
  model.influences_per_vertex = 1;
  const auto add_box = [&](const std::string& joint, const Vec3& low, const Vec3& high) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 place((corner & 1) != 0 ? high.x() : low.x(), (corner & 2) != 0 ? high.y() : 0,
                       (corner & 4) != 0 ? high.z() : low.z());
      model.positions.push_back(place.cast<float>());
      model.influence_joints.push_back(static_cast<std::uint16_t>(skeleton.find("rig:" + joint)));
      model.influence_weights.push_back(1);
    }
  };
  for (const double side : {0.17, -0.17}) {
    const std::string name = side > 0 ? "Left" : "Right";
    add_box(name + "Foot", {side - 0.07, 0, -0.13}, {side + 0.07, 0.14, 0.09});
    add_box(name + "ToeBase", {side - 0.07, 0, 0.1}, {side + 0.07, 0.1, 0.29});
  }
  return model;
}

// The lowest that the boots are in any frame.
double lowest_of(const Model& boots, const Clip& clip) {
  double lowest = 1e9;
  for (std::size_t v = 0; v < boots.positions.size(); ++v) {
    const int joint = boots.influence_joints[v];
    const Vec3 place =
        boots.skeleton.reference[at(joint)].inverse() * boots.positions[v].cast<double>();
    for (int f = 0; f < clip.frame_count(); ++f) {
      lowest = std::min(lowest, (joint_at(clip, f, joint) * place).y());
    }
  }
  return lowest;
}

TEST(ShortLegs, PointsOfBootsAreTheirOutline) {
  const Skeleton skeleton = with_other_axes(chibi_skeleton(), 4);
  const auto points = retarget::points_of_feet(boots_on(skeleton), skeleton, find_roles(skeleton));
  Eigen::AlignedBox3d left;
  for (const retarget::BodyPoint& point : points) {
    const Vec3 place = point.in(skeleton.reference);
    if (place.x() > 0) left.extend(place);
  }
  EXPECT_NEAR((left.min() - Vec3(0.17, 0, -0.13)).norm(), 0, 1e-6);
  EXPECT_NEAR(left.max().x(), 0.17, 1e-6);
  EXPECT_NEAR(left.max().z(), 0.29, 1e-6);
  Model bare = boots_on(skeleton);
  bare.positions.clear();
  EXPECT_TRUE(retarget::points_of_feet(bare, skeleton, find_roles(skeleton)).empty());
}

// Tips of boots went 0.1 m and more into the ground as the foot pushed off.
TEST(ShortLegs, TipsOfBootsStayAboveTheGround) {
  const Clip source = walk_of(1.75).clip;
  const Skeleton target = with_other_axes(chibi_skeleton(), 4);
  const Model boots = boots_on(target);
  const auto sunk = transfer(source, target, {.target_floor = 0.0});
  const auto made =
      transfer(source, target,
               {.target_floor = 0.0,
                .target_feet = retarget::points_of_feet(boots, target, find_roles(target))});
  ASSERT_TRUE(sunk.ok() && made.ok());
  EXPECT_LT(lowest_of(boots, sunk->clip), -0.04);
  EXPECT_GT(lowest_of(boots, made->clip), -0.015);
  EXPECT_LT(made->report.left_foot->largest_depth, 0.005);
  // Balls in contact are where they were; heels are higher by what is behind them.
  for (const auto* one : {&*sunk, &*made}) {
    for (const retarget::ContactReport& contact : one->report.contacts) {
      EXPECT_LT(contact.height, contact.part.ends_with("ball") ? 0.02 : 0.035)
          << contact.part << " " << contact.start;
    }
  }
}

double largest_acceleration(const Clip& clip, int joint) {
  double most = 0;
  for (int f = 1; f + 1 < clip.frame_count(); ++f) {
    const Vec3 change =
        place_of(clip, f + 1, joint) - 2 * place_of(clip, f, joint) + place_of(clip, f - 1, joint);
    most = std::max(most, clip.rate * clip.rate * change.norm());
  }
  return most;
}

// Would fail (27 times the source's) if feet were placed at once as shanks are no longer level.
TEST(ShortLegs, KneesBendSoftlyAsLegsSwingDown) {
  Clip source;
  source.skeleton = human_skeleton();
  source.rate = 120;
  source.resize(120);
  std::vector<Transform> pose(source.skeleton.names.size());
  for (int f = 0; f < source.frame_count(); ++f) {
    const double u = std::min(f / 60.0, 1.0);
    const double left = 1 - u * u * u * (10 + u * (6 * u - 15));
    const Transform hips = source.skeleton.reference[0];
    const Transform turned{hips.position, from_rotation_vector(Vec3(2.2 * left, 0, 0))};
    for (std::size_t j = 0; j < pose.size(); ++j) {
      pose[j] = turned * Transform{-hips.position, Quat::Identity()} * source.skeleton.reference[j];
    }
    source.set_pose(f, pose);
  }
  const Skeleton target = with_other_axes(chibi_skeleton(), 4);
  const auto made = transfer(source, target);
  ASSERT_TRUE(made.ok());
  for (const Role knee : {Role::left_lower_leg, Role::right_lower_leg}) {
    const double own = made->report.scale * largest_acceleration(source, joint_of(source, knee));
    EXPECT_LT(largest_acceleration(made->clip, joint_of(made->clip, knee)), 10 * own);
  }
}

// By how much a knee is bent in a frame, degrees.
double knee_bend(const Clip& clip, int frame, const LegRoles& leg) {
  const Vec3 knee = place_of(clip, frame, joint_of(clip, leg.lower));
  return degrees_between(knee - place_of(clip, frame, joint_of(clip, leg.upper)),
                         place_of(clip, frame, joint_of(clip, leg.foot)) - knee);
}

// The most that a knee bends or straightens in a frame, degrees.
double knee_step(const Clip& clip) {
  double most = 0;
  for (const LegRoles& leg : kLegRoles) {
    for (int f = 1; f < clip.frame_count(); ++f) {
      most = std::max(most, std::abs(knee_bend(clip, f, leg) - knee_bend(clip, f - 1, leg)));
    }
  }
  return most;
}

// A leg that is led too far was as straight as it may be, then bent by three times what the
// source's does in a frame and more.
TEST(ShortLegs, KneesOfActorsThatAreLedDoNotSnap) {
  samples::WalkOptions options;
  options.steps = 6;
  options.stature = 1.5;
  options.step_length = 0.8;
  auto walk = samples::make_walk(options);
  ASSERT_TRUE(walk.ok());
  const Clip& source = walk->clip;
  const auto made = on_short_legs(source);
  ASSERT_TRUE(made.ok());
  EXPECT_LT(knee_step(made->clip), 2.6 * knee_step(source));
}

// Knees that are bent otherwise than the source's would pass without a word.
TEST(ShortLegs, WhatKneesAreBentByIsReported) {
  const auto walk = samples::make_walk({});
  ASSERT_TRUE(walk.ok());
  const auto made = transfer(walk->clip, with_other_axes(human_skeleton(1.4), 4), {.scale = 1});
  ASSERT_TRUE(made.ok());
  for (std::size_t side = 0; side < 2; ++side) {
    const auto& report = *(side == 0 ? made->report.left_foot : made->report.right_foot);
    double most = 0;
    for (int f = 0; f < walk->clip.frame_count(); ++f) {
      const double change =
          knee_bend(made->clip, f, kLegRoles[side]) - knee_bend(walk->clip, f, kLegRoles[side]);
      if (std::abs(change) > std::abs(most)) most = change;
    }
    EXPECT_GT(std::abs(most), 3);
    EXPECT_NEAR(report.largest_bend / kRadiansPerDegree, most, 1.5);
  }
}

// Captures whose legs differ by 2 % bent the shorter leg's knee by 20 degrees on even legs, all the
// way: its foot was kept as much higher as the skeleton has it.
TEST(ShortLegs, UnevenLegsOfTheInputDoNotBendKnees) {
  const auto walk = samples::make_walk({});
  ASSERT_TRUE(walk.ok());
  Clip uneven = walk->clip;
  Skeleton& skeleton = uneven.skeleton;
  const RoleMap roles = find_roles(skeleton);
  LocalMotion local = local_motion(walk->clip);
  const std::vector<Transform> even = skeleton.reference;
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const bool shorter =
        j == roles.joint(Role::left_lower_leg) || j == roles.joint(Role::left_foot);
    const double scale = shorter ? 0.98 : 1;
    const std::size_t parent = at(skeleton.parents[at(j)]);
    skeleton.reference[at(j)].position = skeleton.reference[parent].position +
                                         scale * (even[at(j)].position - even[parent].position);
    for (Vec3& position : local.joint_positions(j)) position *= scale;
  }
  set_local_motion(local, uneven);
  const auto made = transfer(uneven, with_other_axes(walk->clip.skeleton, 4), {.scale = 1});
  ASSERT_TRUE(made.ok());
  double mean = 0;
  for (int f = 0; f < uneven.frame_count(); ++f) {
    mean += (knee_bend(made->clip, f, kLegRoles[0]) - knee_bend(uneven, f, kLegRoles[0])) /
            uneven.frame_count();
  }
  EXPECT_LT(std::abs(mean), 3);
}

// Who has short thighs folds his knees further than others can: their ankles went through their
// hips, and a leg turned by 171 degrees, through the floor, for some frames.
TEST(ShortLegs, DeepSquatsOfShortThighsFoldNoLegThroughItsHip) {
  const auto with_thighs = [](double longer) {
    Skeleton skeleton = human_skeleton(1.75);
    for (const char* knee : {"LeftLeg", "RightLeg"}) {
      skeleton.reference[at(skeleton.find(knee))].position.y() -= longer;
    }
    return skeleton;
  };
  const Skeleton skeleton = with_thighs(-0.113);
  Clip clip = resting(skeleton);
  clip.rate = 60;
  clip.resize(120);
  for (int f = 0; f < 120; ++f) {
    const double fold = 0.5 - 0.5 * std::cos(2 * kPi * f / 119);
    Skeleton pose = skeleton;
    for (const char* side : {"Left", "Right"}) {
      const std::string of = side;
      const auto turn = [&](const char* joint, double degrees) {
        pose = posed(pose, of + joint,
                     from_rotation_vector(degrees * kRadiansPerDegree * fold * Vec3::UnitX()));
      };
      turn("UpLeg", -200);
      turn("Leg", 184);
      turn("Foot", 16);
    }
    const auto foot = at(skeleton.find("LeftFoot"));
    const Vec3 down = skeleton.reference[foot].position - pose.reference[foot].position;
    for (Transform& joint : pose.reference) joint.position += down;
    clip.set_pose(f, pose.reference);
  }
  const auto made = transfer(clip, with_other_axes(with_thighs(0.02), 4));
  ASSERT_TRUE(made.ok());
  const auto thigh = [&](int f) { return bone(made->clip, f, "rig:LeftUpLeg", "rig:LeftLeg"); };
  for (int f = 1; f < 120; ++f) {
    EXPECT_LT(degrees_between(thigh(f - 1), thigh(f)), 10) << f;
    EXPECT_GT(place_of(made->clip, f, joint_of(made->clip, Role::left_lower_leg)).y(), 0.1) << f;
  }
}

// A leg that is too short for its steps straightened from 25 degrees and more in a frame.
TEST(ShortLegs, KneesDoNotSnapStraight) {
  samples::WalkOptions options;
  options.steps = 6;
  options.step_length = 0.95;
  const auto walk = samples::make_walk(options);
  ASSERT_TRUE(walk.ok());
  for (const double stature : {1.25, 1.1}) {
    const auto made =
        transfer(walk->clip, with_other_axes(human_skeleton(stature), 4), {.scale = 1});
    ASSERT_TRUE(made.ok());
    EXPECT_GT(made->report.left_foot->largest_miss, 0.01);
    EXPECT_LT(knee_step(made->clip), 2 * knee_step(walk->clip)) << stature;
  }
}

}  // namespace
}  // namespace krok
