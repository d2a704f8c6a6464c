// If these fail, limbs of a retargeted motion point elsewhere than the source's, or joints that the
// source knows nothing of move by themselves.
#include "retarget/retarget.h"

#include <gtest/gtest.h>

#include <cstring>

#include "retarget/stance.h"
#include "retarget/take_pool.h"
#include "support/skeleton_text.h"
#include "tests/unit/retarget/actors.h"

namespace krok {
namespace {

using namespace test;
using retarget::Method;

constexpr std::pair<const char*, const char*> kLimbs[] = {
    {"LeftArm", "LeftForeArm"},    {"LeftForeArm", "LeftHand"}, {"RightArm", "RightForeArm"},
    {"RightForeArm", "RightHand"}, {"LeftUpLeg", "LeftLeg"},    {"LeftLeg", "LeftFoot"},
    {"RightUpLeg", "RightLeg"},    {"RightLeg", "RightFoot"}};

// The largest angle in degrees between limbs of two motions of skeletons with the same names but
// for a prefix of the second's.
double largest_limb_angle(const Clip& a, const Clip& b, const std::string& prefix = "rig:") {
  double largest = 0;
  for (int f = 0; f < a.frame_count(); ++f) {
    for (const auto& [from, to] : kLimbs) {
      largest = std::max(
          largest, degrees_between(bone(a, f, from, to), bone(b, f, prefix + from, prefix + to)));
    }
  }
  return largest;
}

TEST(Retarget, TheAxesOfJointsDoNotMatter) {
  const Clip clip = lively_clip(with_turned_joints(human_skeleton()));
  for (const unsigned seed : {1u, 2u, 3u}) {
    const auto result = transfer(clip, with_other_axes(clip.skeleton, seed));
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result->report.method, Method::roles);
    EXPECT_NEAR(result->report.scale, 1, 1e-9);
    EXPECT_LT(largest_distance(result->clip, clip), 2e-6);
  }
}

TEST(Retarget, AScaledActorMovesScaled) {
  const Clip clip = lively_clip(human_skeleton());
  const auto result = transfer(clip, scaled(with_other_axes(clip.skeleton, 5), 0.5));
  ASSERT_TRUE(result.ok());
  EXPECT_NEAR(result->report.scale, 0.5, 1e-9);
  EXPECT_LT(largest_distance(result->clip, clip, 0.5), 2e-6);
}

// A T-pose, an A-pose, arms forward, arms down, a sitting pose, turned round: one motion.
TEST(Retarget, TheReferencePoseDoesNotMatter) {
  const Skeleton skeleton = human_skeleton();
  const Clip clip = lively_clip(skeleton);
  const Quat a_pose = from_rotation_vector(Vec3(0, 0, -0.8));
  const Quat down = from_rotation_vector(Vec3(0, 0, -1.5));
  const Quat forward = from_rotation_vector(Vec3(0, -kPi / 2, 0));
  const auto arms = [&](const Quat& left) {
    const Quat right(left.w(), left.x(), -left.y(), -left.z());  // mirrored in x
    return posed(posed(skeleton, "LeftArm", left), "RightArm", right);
  };
  Skeleton sitting = posed(skeleton, "LeftUpLeg", from_rotation_vector(Vec3(-1.2, 0, 0)));
  sitting = posed(sitting, "LeftLeg", from_rotation_vector(Vec3(1.2, 0, 0)));
  const Skeleton variants[] = {
      arms(a_pose),
      arms(down),
      arms(forward),
      posed(arms(a_pose), "LeftForeArm", from_rotation_vector(Vec3(0, -0.9, 0))),
      posed(skeleton, "Hips", from_rotation_vector(Vec3(0, 2.5, 0))),
      sitting};
  for (std::size_t i = 0; i < std::size(variants); ++i) {
    const auto result = transfer(clip, with_other_axes(variants[i], 8));
    ASSERT_TRUE(result.ok());
    EXPECT_LT(largest_distance(result->clip, clip), 1e-5) << "variant " << i;
  }
}

// The forearm of Acclaim skeletons has a joint that turns the hand, the palm's joint bends it.
// Would fail if a motion that comes back from one hand joint bent the forearm in its middle, by up
// to 67 degrees in captures of CMU.
TEST(Retarget, AWristInTheForearmTwistsAndThePalmBends) {
  const Skeleton plain = human_skeleton();
  Skeleton acclaim;
  for (int j = 0; j < plain.joint_count(); ++j) {
    const std::string& name = plain.names[at(j)];
    const int parent = plain.parents[at(j)];
    Transform place = plain.reference[at(j)];
    if (name.ends_with("Hand_end")) {
      const std::string side = name.substr(0, name.find("Hand"));
      const int wrist = acclaim.find(side + "Hand");
      const int palm = acclaim.add(side + "FingerBase", wrist, plain.reference[at(parent)]);
      const Vec3 hand = place.position - plain.reference[at(parent)].position;
      place.position -= 0.5 * hand;
      const int fingers = acclaim.add(side[0] + std::string("Fingers"), palm, place);
      place.position += 0.5 * hand;
      acclaim.add(name, fingers, place, true);
      continue;
    }
    if (name.ends_with("Hand")) {
      const Vec3& elbow = plain.reference[at(parent)].position;
      place.position = elbow + 0.66 * (place.position - elbow);
    }
    acclaim.add(name, parent < 0 ? -1 : acclaim.find(plain.names[at(parent)]), place,
                plain.end_sites[at(j)] != 0);
  }
  Clip clip = lively_clip(acclaim);
  const auto turned = [&](int f, const char* joint, const Vec3& turn,
                          std::vector<Transform>& pose) {
    const int root = acclaim.find(joint);
    clip.get_pose(f, pose);
    std::vector<Transform> local(pose.size());
    world_to_local(acclaim.parents, pose, local);
    local[at(root)].orientation = from_rotation_vector(turn);
    local_to_world(acclaim.parents, local, pose);
    clip.set_pose(f, pose);
  };
  std::vector<Transform> pose(acclaim.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    const double swing = std::sin(0.3 * f);
    turned(f, "LeftHand", Vec3(1.2 * swing, 0, 0), pose);
    turned(f, "LeftFingerBase", Vec3(0, 0.2, 0.9 * swing), pose);
  }
  const auto there = transfer(clip, with_other_axes(plain, 3));
  ASSERT_TRUE(there.ok());
  const auto back = transfer(there->clip, acclaim);
  ASSERT_TRUE(back.ok());
  double off = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (const char* joint : {"LeftForeArm", "LeftHand", "LeftFingerBase"}) {
      const auto j = at(acclaim.find(joint));
      off = std::max(off, angle_between(clip.frame_orientations(f)[j].cast<double>(),
                                        back->clip.frame_orientations(f)[j].cast<double>()));
    }
  }
  EXPECT_LT(off / kRadiansPerDegree, 6);
}

// Collars that are raised with the arms are turned back with them: the shoulders stay as wide as
// they are. A collar that points elsewhere under arms that do not is build, and stays.
TEST(Retarget, CollarsRiseWithArmsOnly) {
  const Skeleton skeleton = human_skeleton();
  const Clip clip = lively_clip(skeleton);
  const auto collars = [&](double up, double arms) {
    Skeleton result = skeleton;
    for (const double sign : {1.0, -1.0}) {
      const char* const side = sign > 0 ? "Left" : "Right";
      const auto turn = [sign](double angle) {
        return from_rotation_vector(Vec3(0, 0, sign * angle));
      };
      result = posed(result, std::string(side) + "Shoulder", turn(up));
      result = posed(result, std::string(side) + "Arm", turn(arms - up));
    }
    return result;
  };
  const auto width = [](const Clip& of, const std::string& prefix) {
    const auto positions = of.frame_positions(3);
    return static_cast<double>((positions[at(of.skeleton.find(prefix + "LeftArm"))] -
                                positions[at(of.skeleton.find(prefix + "RightArm"))])
                                   .norm());
  };
  const Skeleton raised = with_other_axes(collars(1.4, 1.5), 8);
  const auto onto = transfer(clip, raised);
  ASSERT_TRUE(onto.ok());
  EXPECT_LT(largest_distance(onto->clip, clip), 1e-5);
  const auto back = transfer(onto->clip, skeleton);
  ASSERT_TRUE(back.ok());
  EXPECT_LT(largest_distance(back->clip, clip), 1e-5);
  const auto build = transfer(clip, with_other_axes(collars(1.0, 0), 8));
  ASSERT_TRUE(build.ok());
  EXPECT_LT(width(build->clip, "rig:"), 0.8 * width(clip, ""));
}

// Random reference poses of all limbs, on both sides of the transfer.
TEST(Retarget, RandomReferencePosesGiveTheSameMotion) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto turn = [&](double size) {
    return from_rotation_vector(size * Vec3(normal(random), normal(random), normal(random)));
  };
  const Clip clip = lively_clip(human_skeleton(), 12);
  for (int round = 0; round < 10; ++round) {
    Skeleton target = human_skeleton();
    for (const char* joint : {"LeftArm", "LeftForeArm", "RightArm", "RightForeArm"}) {
      target = posed(target, joint, turn(0.4));
    }
    for (const char* joint : {"LeftUpLeg", "LeftLeg", "RightUpLeg", "RightLeg"}) {
      target = posed(target, joint, turn(0.15));
    }
    const Quat whole = from_rotation_vector(Vec3(0, 3 * normal(random), 0));
    target = with_other_axes(posed(target, "Hips", whole), static_cast<unsigned>(round));
    const auto result = transfer(clip, target, {.feet = retarget::Feet::free});
    ASSERT_TRUE(result.ok());
    EXPECT_LT(largest_limb_angle(clip, result->clip), 0.01) << "round " << round;
  }
}

TEST(Retarget, LimbsOfOtherLengthsPointTheSameWay) {
  const Clip clip = lively_clip(human_skeleton());
  Skeleton target = with_other_axes(human_skeleton(1.6), 4);
  // Longer forearms and thighs, broader hips.
  const auto move = [&](const char* joint, const Vec3& by) {
    const int root = target.find(joint);
    std::vector<char> inside(target.names.size(), 0);
    for (int j = root; j < target.joint_count(); ++j) {
      const int parent = target.parents[at(j)];
      inside[at(j)] = j == root || inside[at(parent)] != 0 ? 1 : 0;
      if (inside[at(j)] != 0) target.reference[at(j)].position += by;
    }
  };
  move("rig:LeftHand", Vec3(0.05, 0, 0));
  move("rig:RightHand", Vec3(-0.05, 0, 0));
  move("rig:LeftUpLeg", Vec3(0.02, 0, 0));
  move("rig:RightUpLeg", Vec3(-0.02, 0, 0));
  move("rig:LeftLeg", Vec3(0, -0.03, 0));
  move("rig:RightLeg", Vec3(0, -0.03, 0));
  const auto free = transfer(clip, target, {.feet = retarget::Feet::free});
  ASSERT_TRUE(free.ok());
  EXPECT_LT(largest_limb_angle(clip, free->clip), 0.01);
  const auto kept = transfer(clip, target);
  ASSERT_TRUE(kept.ok());
  EXPECT_LT(largest_limb_angle(clip, kept->clip), 5);
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (const char* end : {"rig:LeftHand", "rig:LeftHand_end", "rig:LeftLeg"}) {
      const int joint = target.find(end);
      const int parent = target.parents[at(joint)];
      const auto positions = kept->clip.frame_positions(f);
      EXPECT_NEAR((positions[at(joint)] - positions[at(parent)]).norm(),
                  target.reference_local(joint).position.norm(), 1e-5);
    }
  }
}

// Turns since the reference pose, as the world sees them.
Quat turn_of(const Clip& clip, int frame, const std::string& joint) {
  const int j = clip.skeleton.find(joint);
  return clip.frame_orientations(frame)[at(j)].cast<double>().normalized() *
         clip.skeleton.reference[at(j)].orientation.conjugate();
}

TEST(Retarget, SpinesOfOtherNumbersOfJointsBendAlongTheirLength) {
  const Clip clip = lively_clip(human_skeleton());
  for (const int joints : {0, 1, 2, 5}) {
    // Hips, `joints` of spine, chest, and the rest as before.
    Skeleton target;
    const Skeleton human = human_skeleton();
    std::map<std::string, int> made;
    for (int j = 0; j < human.joint_count(); ++j) {
      const std::string& name = human.names[at(j)];
      if (name == "Spine" || name == "Spine1") continue;
      int parent = human.parents[at(j)] < 0 ? -1 : made[human.names[at(human.parents[at(j)])]];
      if (name == "Spine2") {
        for (int i = 0; i < joints; ++i) {
          const double place = (i + 1.0) / (joints + 1);
          Transform between = human.reference[0];
          between.position += place * (human.reference[at(j)].position - between.position);
          parent =
              target.add("Back" + std::to_string(i), parent == 0 || i > 0 ? parent : 0, between);
        }
      }
      made[name] = target.add(name == "Spine2" ? "Chest" : name, parent, human.reference[at(j)],
                              human.end_sites[at(j)] != 0);
    }
    const auto result = transfer(clip, target);
    ASSERT_TRUE(result.ok());
    for (int f = 0; f < clip.frame_count(); ++f) {
      EXPECT_LT(angle_between(turn_of(clip, f, "Spine2"), turn_of(result->clip, f, "Chest")), 1e-5);
      EXPECT_LT(angle_between(turn_of(clip, f, "Hips"), turn_of(result->clip, f, "Hips")), 1e-5);
      EXPECT_LT(angle_between(turn_of(clip, f, "Head"), turn_of(result->clip, f, "Head")), 1e-5);
      // Each joint of the back bends a part of the whole, none more than all of it.
      double whole = angle_between(turn_of(clip, f, "Hips"), turn_of(clip, f, "Spine")) +
                     angle_between(turn_of(clip, f, "Spine"), turn_of(clip, f, "Spine1")) +
                     angle_between(turn_of(clip, f, "Spine1"), turn_of(clip, f, "Spine2"));
      std::string before = "Hips";
      for (int i = 0; i < joints; ++i) {
        const std::string name = "Back" + std::to_string(i);
        EXPECT_LE(angle_between(turn_of(result->clip, f, before), turn_of(result->clip, f, name)),
                  whole + 1e-5);
        before = name;
      }
    }
  }
}

// A figure without a joint: what hung on it hangs on its parent.
Skeleton without(const Skeleton& from, const std::string& name) {
  Skeleton skeleton;
  std::vector<int> index(from.names.size(), -1);
  for (int j = 0; j < from.joint_count(); ++j) {
    int parent = from.parents[at(j)];
    if (from.names[at(j)] == name) {
      index[at(j)] = index[at(parent)];
      continue;
    }
    index[at(j)] = skeleton.add(from.names[at(j)], parent < 0 ? -1 : index[at(parent)],
                                from.reference[at(j)], from.end_sites[at(j)] != 0);
  }
  return skeleton;
}

TEST(Retarget, ACollarBoneMayBeMissingOnEitherSide) {
  const Clip clip = lively_clip(human_skeleton());
  const Skeleton one = without(human_skeleton(), "LeftShoulder");
  const auto onto = transfer(clip, one, {.feet = retarget::Feet::free});
  ASSERT_TRUE(onto.ok());
  EXPECT_LT(largest_limb_angle(clip, onto->clip, ""), 0.01);
  const Clip short_clip = lively_clip(one);
  const auto from = transfer(short_clip, human_skeleton(), {.feet = retarget::Feet::free});
  ASSERT_TRUE(from.ok());
  EXPECT_LT(largest_limb_angle(short_clip, from->clip, ""), 0.01);
  // The collar that has no partner rests on the chest.
  EXPECT_LT(angle_between(turn_of(from->clip, 9, "LeftShoulder"), turn_of(from->clip, 9, "Spine2")),
            1e-5);
}

TEST(Retarget, NeckToesAndLowerArmMayBeMissing) {
  const Clip clip = lively_clip(human_skeleton());
  for (const char* name : {"Neck", "LeftToeBase", "RightForeArm", "Spine2"}) {
    const Skeleton fewer = without(human_skeleton(), name);
    EXPECT_TRUE(transfer(clip, fewer).ok()) << name;
    EXPECT_TRUE(transfer(lively_clip(fewer), human_skeleton()).ok()) << name;
  }
}

TEST(Retarget, ExtraJointsKeepTheirPlaceOnTheirParents) {
  const Clip clip = lively_clip(human_skeleton());
  Skeleton target = human_skeleton();
  target.names[0] = "Pelvis";
  Transform tail;
  tail.position = Vec3(0, 0.9, -0.3);
  tail.orientation = from_rotation_vector(Vec3(0.4, 0.1, 0));
  target.add("Tail", 0, tail);
  Transform twist = target.reference[at(target.find("LeftForeArm"))];
  twist.position.x() += 0.1;
  target.add("LeftForeArmTwist", target.find("LeftForeArm"), twist);
  const auto result = transfer(clip, target);
  ASSERT_TRUE(result.ok());
  std::vector<Transform> world(target.names.size()), local(target.names.size());
  for (const int f : {0, 13, 39}) {
    result->clip.get_pose(f, world);
    world_to_local(target.parents, world, local);
    for (const char* name : {"Tail", "LeftForeArmTwist", "Head_end", "LeftHand_end"}) {
      const int joint = target.find(name);
      const Transform rest = target.reference_local(joint);
      EXPECT_LT((local[at(joint)].position - rest.position).norm(), 1e-5) << name;
      EXPECT_LT(angle_between(local[at(joint)].orientation, rest.orientation), 1e-5) << name;
    }
  }
  EXPECT_EQ(result->report.following_target,
            (std::vector<int>{target.find("Tail"), target.find("LeftForeArmTwist")}));
}

TEST(Retarget, ARootAboveTheHipsStaysAndOneAtTheirPlaceGoesAlong) {
  const Clip clip = lively_clip(human_skeleton());
  const Skeleton human = human_skeleton();
  for (const double height : {0.0, 0.55 * 1.75}) {
    Skeleton target;
    Transform root;
    root.position.y() = height;
    target.add("Root", -1, root);
    for (int j = 0; j < human.joint_count(); ++j) {
      target.add(human.names[at(j)], human.parents[at(j)] + 1, human.reference[at(j)],
                 human.end_sites[at(j)] != 0);
    }
    const auto result = transfer(clip, target);
    ASSERT_TRUE(result.ok());
    double most = 0;
    for (int f = 0; f < clip.frame_count(); ++f) {
      const auto positions = result->clip.frame_positions(f);
      for (int j = 0; j < human.joint_count(); ++j) {
        most =
            std::max<double>(most, (positions[at(j + 1)] - clip.frame_positions(f)[at(j)]).norm());
      }
      const double away = (positions[0] - positions[1]).norm();
      if (height > 0)
        EXPECT_LT(away, 1e-5);
      else
        EXPECT_LT(positions[0].norm(), 1e-6);
    }
    EXPECT_LT(most, 1e-5);
  }
}

TEST(Retarget, SkeletonsThatAreNoHumansAreMappedByNames) {
  const Skeleton dog =
      skeleton_from_text("body .chest ..head .tail1 ..tail2 .leg_a1 ..leg_a2 .leg_b1 ..leg_b2");
  Skeleton from = dog;
  for (int j = 0; j < dog.joint_count(); ++j) {
    from.reference[at(j)].position = Vec3(std::sin(j), std::cos(2 * j), j);
  }
  const Clip clip = swinging_clip(from, 10, 30);
  Skeleton to = scaled(from, 2);
  for (int j = 0; j < to.joint_count(); ++j) {
    to.reference[at(j)].orientation = from_rotation_vector(Vec3(0.3 * j, 1, -0.2 * j));
  }
  to.add("ear", to.find("head"), to.reference[at(to.find("head"))]);
  const auto result = transfer(clip, to);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->report.method, Method::names);
  EXPECT_NEAR(result->report.scale, 2, 1e-9);
  for (int f = 0; f < 10; ++f) {
    for (int j = 0; j < dog.joint_count(); ++j) {
      EXPECT_LT(
          (result->clip.frame_positions(f)[at(j)] - 2 * clip.frame_positions(f)[at(j)]).norm(),
          1e-4);
    }
  }
}

// A fox whose root stays on the ground while its hips leap. Would fail if the leap were the root's
// alone: other animals dived into the ground.
TEST(Retarget, HipsUnderARootThatStaysCarryTheTravelByNames) {
  Skeleton from = skeleton_from_text("Root .Hips ..Chest ...Head ..Tail1 ...Tail2");
  for (int j = 0; j < from.joint_count(); ++j) {
    from.reference[at(j)].position = Vec3(std::sin(j), j == 0 ? 0 : 1, j);
  }
  Clip clip;
  clip.skeleton = from;
  clip.resize(2);
  clip.set_pose(0, from.reference);
  std::vector<Transform> leap = from.reference;
  for (std::size_t j = 1; j < leap.size(); ++j) leap[j].position.y() += 1;
  clip.set_pose(1, leap);
  Skeleton to = scaled(from, 2);
  to.add("Ear", to.find("Head"), to.reference[at(to.find("Head"))]);
  const auto result = transfer(clip, to);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->report.method, Method::names);
  const auto hips = at(to.find("Hips"));
  EXPECT_NEAR(result->clip.frame_positions(1)[hips].y() - result->clip.frame_positions(0)[hips].y(),
              2, 1e-4);
}

// Would fail if animals whose legs are shorter than the rest of them hung in the air by the
// source's legs, as a cat by 0.13 m in the motions of a fox, or longer legs went into the ground.
TEST(Retarget, PawsStayOnTheGroundByNames) {
  const auto animal = [](double leg) {
    Skeleton made = skeleton_from_text("Hips .Spine ..Chest ...Head ...Paw .Tail");
    const double heights[] = {leg, leg, leg, leg + 0.1, 0, leg};
    for (int j = 0; j < made.joint_count(); ++j) {
      made.reference[at(j)].position = Vec3(0, heights[j], j == 5 ? -0.4 : 0.3 * std::min(j, 2));
    }
    return made;
  };
  Clip clip;
  clip.skeleton = animal(0.5);
  clip.resize(1);
  clip.set_pose(0, clip.skeleton.reference);
  for (const double leg : {0.2, 0.9}) {
    Skeleton to = animal(leg);
    to.add("Ear", to.find("Head"), to.reference[at(to.find("Head"))]);
    const auto result = transfer(clip, to);
    ASSERT_TRUE(result.ok());
    ASSERT_EQ(result->report.method, Method::names);
    EXPECT_NEAR(result->clip.frame_positions(0)[at(to.find("Paw"))].y(), 0, 1e-5) << leg;
  }
}

TEST(Retarget, WhatIsMissingIsSaid) {
  const Skeleton snake = skeleton_from_text("a .b ..c ...d");
  const auto result = transfer(lively_clip(human_skeleton(), 2), snake);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, "retarget-roles");
  EXPECT_NE(result.error().message.find("the target lacks every humanoid role"), std::string::npos)
      << result.error().message;
  const auto empty = transfer(lively_clip(human_skeleton(), 2), Skeleton());
  ASSERT_FALSE(empty.ok());
  EXPECT_EQ(empty.error().code, "retarget-empty");
  const auto scale = transfer(lively_clip(human_skeleton(), 2), human_skeleton(), {.scale = -1.0});
  ASSERT_FALSE(scale.ok());
  EXPECT_EQ(scale.error().code, "retarget-scale");
  const auto frame =
      transfer(lively_clip(human_skeleton(), 2), human_skeleton(), {.source_frame = 2});
  ASSERT_FALSE(frame.ok());
  EXPECT_EQ(frame.error().code, "retarget-frame");
}

TEST(Retarget, BonesWithoutLengthAreNoTrouble) {
  Skeleton flat = human_skeleton();
  flat.names[0] = "Pelvis";
  for (const char* name : {"LeftHand_end", "Neck", "LeftShoulder", "RightToeBase", "LeftLeg"}) {
    const int joint = flat.find(name);
    flat.reference[at(joint)] = flat.reference[at(flat.parents[at(joint)])];
  }
  const Clip clip = lively_clip(human_skeleton(), 5);
  for (const auto& result :
       {transfer(clip, flat), transfer(lively_clip(flat, 5), human_skeleton())}) {
    ASSERT_TRUE(result.ok());
    EXPECT_TRUE(check(result->clip).ok());
  }
  Skeleton point = human_skeleton();
  point.names[0] = "Pelvis";
  for (Transform& joint : point.reference) joint = {};
  EXPECT_FALSE(transfer(clip, point).ok());
}

TEST(Retarget, OneFrameOrNoneIsNoTrouble) {
  const Skeleton target = with_other_axes(human_skeleton(), 2);
  const auto one = transfer(lively_clip(human_skeleton(), 1), target);
  ASSERT_TRUE(one.ok());
  EXPECT_EQ(one->clip.frame_count(), 1);
  const auto none = transfer(resting(human_skeleton()), target);
  ASSERT_TRUE(none.ok());
  EXPECT_EQ(none->clip.frame_count(), 0);
}

TEST(Retarget, ThreadsDoNotChangeTheResult) {
  const Clip clip = lively_clip(human_skeleton(), 200);
  const Skeleton target = with_other_axes(human_skeleton(1.9), 2);
  const auto one = transfer(clip, target, {.jobs = 1});
  const auto four = transfer(clip, target, {.jobs = 4});
  ASSERT_TRUE(one.ok() && four.ok());
  EXPECT_EQ(std::memcmp(one->clip.positions.data(), four->clip.positions.data(),
                        one->clip.positions.size() * sizeof(Vec3f)),
            0);
}

// Bones that all lie along one axis, as some exporters have them: the reference pose is no stance,
// and a T-pose takes its place.
TEST(Retarget, AReferencePoseThatDoesNotStandIsReplacedByATPose) {
  const Clip clip = lively_clip(human_skeleton());
  Skeleton heap = human_skeleton();
  for (const char* name : {"LeftUpLeg", "RightUpLeg"}) {
    heap = posed(heap, name, from_rotation_vector(Vec3(3, 0, 0)));
  }
  heap = posed(heap, "Spine1", from_rotation_vector(Vec3(0, 0, -1.5)));  // the trunk lies aside
  Clip same_motion = clip;
  same_motion.skeleton = heap;
  const auto result =
      transfer(same_motion, with_other_axes(human_skeleton(), 6), {.feet = retarget::Feet::free});
  ASSERT_TRUE(result.ok());
  EXPECT_FALSE(result->report.source_frame.has_value());
  EXPECT_LT(largest_limb_angle(clip, result->clip), 0.01);
}

// The constant turn from a source joint's orientation to a target joint's.
Quat turn_between(const Clip& source, const std::string& joint, const Clip& target) {
  const auto orientation = [&](const Clip& clip, const std::string& name) {
    const auto j = at(clip.skeleton.find(name));
    return clip.frame_orientations(0)[j].cast<double>().normalized();
  };
  return orientation(source, joint).conjugate() * orientation(target, "rig:" + joint);
}

// How a skeleton is aligned belongs to it, not to what is done in a take: a walk, a part of it with
// other bends, one whose left arm is never bent, and one that hops on a leg with a hand turned
// aside are aligned alike.
TEST(Retarget, TakesOfASkeletonAreAlignedAlike) {
  const Skeleton heap = human_skeleton();
  Skeleton folded = heap;
  for (const char* name : {"LeftUpLeg", "RightUpLeg"}) {
    folded = posed(folded, name, from_rotation_vector(Vec3(3, 0, 0)));
  }
  for (const double side : {1.0, -1.0}) {
    const std::string arm = side > 0 ? "LeftShoulder" : "RightShoulder";
    folded = posed(folded, arm, from_rotation_vector(Vec3(0, 0, side * 1.5)));
  }
  Clip walk = lively_clip(heap, 60), part, stiff = walk, hop = walk;
  part = walk;
  part.resize(0);
  part.resize(12);
  std::vector<Transform> pose(heap.names.size());
  for (int f = 0; f < 12; ++f) {
    walk.get_pose(20 + f, pose);
    part.set_pose(f, pose);
  }
  const int elbow = heap.find("LeftForeArm");
  std::vector<Transform> local(pose.size());
  for (int f = 0; f < stiff.frame_count(); ++f) {
    stiff.get_pose(f, pose);
    world_to_local(heap.parents, pose, local);
    local[at(elbow)] = heap.reference_local(elbow);
    local_to_world(heap.parents, local, pose);
    stiff.set_pose(f, pose);
  }
  for (int f = 0; f < hop.frame_count(); ++f) {
    hop.get_pose(f, pose);
    world_to_local(heap.parents, pose, local);
    const int hand = heap.find("RightHand"), knee = heap.find("LeftLeg");
    local[at(hand)].orientation =
        heap.reference_local(hand).orientation * from_rotation_vector(Vec3(1.55, 0.2, 0));
    local[at(knee)].orientation =
        heap.reference_local(knee).orientation * from_rotation_vector(Vec3(1.4, 0, 0));
    local_to_world(heap.parents, local, pose);
    hop.set_pose(f, pose);
  }
  std::vector<Clip> made;
  for (Clip* clip : {&walk, &part, &stiff, &hop}) {
    clip->skeleton = folded;
    auto result =
        transfer(*clip, with_other_axes(human_skeleton(), 6), {.feet = retarget::Feet::free});
    ASSERT_TRUE(result.ok());
    made.push_back(std::move(result->clip));
  }
  for (const char* joint :
       {"Hips", "Spine2", "Head", "LeftArm", "LeftForeArm", "LeftHand", "RightArm", "RightHand",
        "LeftUpLeg", "LeftLeg", "RightLeg", "LeftFoot"}) {
    const Quat first = turn_between(walk, joint, made[0]);
    EXPECT_LT(angle_between(first, turn_between(part, joint, made[1])), 3 * kRadiansPerDegree)
        << joint;
    EXPECT_LT(angle_between(first, turn_between(stiff, joint, made[2])), 3 * kRadiansPerDegree)
        << joint;
    EXPECT_LT(angle_between(first, turn_between(hop, joint, made[3])), 3 * kRadiansPerDegree)
        << joint;
  }
}

// Rigs whose toes are bent in the reference pose, or straight there and bent wherever the foot
// stands: the target's lie flat as in its own reference pose, and do not curl up.
TEST(Retarget, ToesLieFlatWhereTheInputsDo) {
  const Skeleton human = human_skeleton();
  Skeleton folded = human;
  Clip walk = lively_clip(human, 60);
  std::vector<Transform> pose(human.names.size()), local(pose.size());
  for (int f = 0; f < walk.frame_count(); ++f) {
    walk.get_pose(f, pose);
    world_to_local(human.parents, pose, local);
    for (const char* toes : {"LeftToeBase", "RightToeBase"}) {
      local[at(human.find(toes))] = human.reference_local(human.find(toes));
    }
    local_to_world(human.parents, local, pose);
    walk.set_pose(f, pose);
  }
  for (const std::string side : {"Left", "Right"}) {
    folded = posed(folded, side + "UpLeg", from_rotation_vector(Vec3(3, 0, 0)));
    folded = posed(folded, side + "ToeBase", from_rotation_vector(Vec3(0.5, 0, 0)));
  }
  walk.skeleton = folded;
  const Skeleton target = with_other_axes(human, 6);
  const auto result = transfer(walk, target, {.feet = retarget::Feet::free});
  ASSERT_TRUE(result.ok());
  result->clip.get_pose(7, pose);
  world_to_local(target.parents, pose, local);
  for (const char* toes : {"rig:LeftToeBase", "rig:RightToeBase"}) {
    const int joint = target.find(toes);
    EXPECT_LT(
        angle_between(local[at(joint)].orientation, target.reference_local(joint).orientation),
        2 * kRadiansPerDegree)
        << toes;
  }
}

// Some rigs hang a part of the body on the root, beside the hips: it goes along with them instead
// of being left where the walk began.
TEST(Retarget, PartsBesideTheHipsGoAlong) {
  const Skeleton human = human_skeleton();
  Skeleton rooted;
  rooted.add("root", -1, {});
  const int belly =
      rooted.add("belly", 0, {human.reference[0].position + Vec3(0, 0.1, 0.1), Quat::Identity()});
  const int navel = rooted.add("navel", belly,
                               rooted.reference[1] * Transform{Vec3(0, 0, 0.1), Quat::Identity()});
  for (int j = 0; j < human.joint_count(); ++j) {
    const int parent = human.parents[at(j)];
    rooted.add(human.names[at(j)], parent < 0 ? 0 : parent + 3, human.reference[at(j)]);
  }
  Clip walk = lively_clip(human, 30);
  for (int f = 0; f < walk.frame_count(); ++f) {
    for (Vec3f& p : walk.frame_positions(f)) p.z() += 0.1F * static_cast<float>(f);
  }
  const auto result = transfer(walk, rooted, {});
  ASSERT_TRUE(result.ok());
  std::vector<Transform> pose(rooted.names.size());
  for (const int frame : {3, 29}) {
    result->clip.get_pose(frame, pose);
    for (const int joint : {belly, navel}) {
      const Transform now = pose[3].inverse() * pose[at(joint)];
      const Transform own = rooted.reference[3].inverse() * rooted.reference[at(joint)];
      EXPECT_LT((now.position - own.position).norm(), 1e-5) << frame;
      EXPECT_LT(angle_between(now.orientation, own.orientation), 1e-5) << frame;
    }
    EXPECT_LT(pose[0].position.norm(), 1e-6);
  }
}

// What several takes show together; one that begins with a T-pose decides for all of them.
TEST(Retarget, TakesTogetherGiveOneStance) {
  const Skeleton human = human_skeleton();
  Skeleton folded = human;
  for (const char* name : {"LeftUpLeg", "RightUpLeg"}) {
    folded = posed(folded, name, from_rotation_vector(Vec3(3, 0, 0)));
  }
  Clip walk = lively_clip(human, 60), posing = walk;
  posing.set_pose(0, human.reference);
  walk.skeleton = posing.skeleton = folded;
  const RoleMap roles = find_roles(folded);
  retarget::TakePool pool(2, roles), other(2, roles);
  pool.add(walk);
  const Clip alone = pool.clip();
  pool.add(posing);
  other.add(posing);
  other.add(walk);
  EXPECT_EQ(alone.frame_count(), 60);
  EXPECT_EQ(pool.clip().frame_count(), 121);
  for (const retarget::TakePool* takes : {&pool, &other}) {
    const auto stance = retarget::find_stance(takes->clip(), roles, std::nullopt);
    ASSERT_TRUE(stance.ok());
    for (std::size_t j = 0; j < stance->pose.size(); ++j) {
      const Transform& wanted = human.reference[j];
      EXPECT_LT((stance->pose[j].position - wanted.position).norm(), 1e-5);
      EXPECT_LT(angle_between(stance->pose[j].orientation, wanted.orientation), 1e-3);
    }
  }
  EXPECT_EQ(retarget::TakePool(100'000, roles).clip().frame_count(), 0);
}

// Would fail if a step, which files without another reference pose have as theirs, was taken for
// how the body stands: a foot came out 49 degrees off, the trunk as bent as the step leaned.
TEST(Retarget, AStepIsNoStance) {
  const Skeleton human = human_skeleton();
  Clip walk = lively_clip(human, 60);
  const RoleMap roles = find_roles(human);
  for (int f = 0; f < walk.frame_count(); ++f) {
    std::vector<Transform> pose(human.names.size());
    walk.get_pose(f, pose);
    for (Transform& joint : pose)
      joint = Transform{Vec3::Zero(), from_rotation_vector(Vec3(0.3, 0, 0))} * joint;
    walk.set_pose(f, pose);
  }
  int steps = 0;
  for (int f = 0; f < walk.frame_count(); f += 3) {
    if (std::abs(std::sin(5 * f / 30.0)) < 0.7) continue;
    ++steps;
    walk.get_pose(f, walk.skeleton.reference);
    const auto stance = retarget::find_stance(walk, roles, std::nullopt);
    ASSERT_TRUE(stance.ok());
    const auto along = [&](const char* from, const char* to) {
      return (stance->pose[at(human.find(to))].position -
              stance->pose[at(human.find(from))].position)
          .normalized();
    };
    for (const char* side : {"Left", "Right"}) {
      const std::string name = side;
      EXPECT_LT(along((name + "UpLeg").c_str(), (name + "Leg").c_str()).y(), -0.99) << f;
      EXPECT_LT(along((name + "Leg").c_str(), (name + "Foot").c_str()).y(), -0.99) << f;
    }
    EXPECT_GT(along("Hips", "Neck").y(), 0.99) << f;
  }
  EXPECT_GT(steps, 5);
}

// Would fail if eyes of a target whose reference pose keeps no face came out beside the head.
TEST(Retarget, AFaceIsThatOfTheTargetsMotion) {
  const Clip walk = lively_clip(human_skeleton());
  Skeleton rig = human_skeleton();
  const int head = rig.find("Head"), eye = rig.joint_count();
  Transform of_eye = rig.reference[at(head)];
  of_eye.position.z() += 0.1;
  rig.add("Eye", head, of_eye);
  const Clip own = lively_clip(rig);
  // The same motion, on a reference pose that is folded and has the face turned.
  Clip target = own;
  for (const char* name : {"LeftUpLeg", "RightUpLeg", "LeftLeg", "RightLeg"}) {
    target.skeleton = posed(target.skeleton, name, from_rotation_vector(Vec3(1.6, 0, 0)));
  }
  target.skeleton = posed(target.skeleton, "Eye", from_rotation_vector(Vec3(0, 1.5, 0)));
  const auto result = transfer(walk, target);
  ASSERT_TRUE(result.ok());
  const auto turn = [&](const Clip& clip) {
    return Quat(clip.frame_orientations(0)[at(head)].conjugate().cast<double>() *
                clip.frame_orientations(0)[at(eye)].cast<double>());
  };
  EXPECT_LT(angle_between(turn(result->clip), turn(own)), 1e-3);
  // One that only lies has its face: a wink in the first frame is not taken for it.
  Clip lying = own;
  lying.skeleton = posed(rig, "Hips", from_rotation_vector(Vec3(-1.6, 0, 0)));
  lying.orientations[at(eye)] =
      lying.orientations[at(eye)] * from_rotation_vector(Vec3(0, 1.0, 0)).cast<float>();
  const auto kept = transfer(walk, lying);
  ASSERT_TRUE(kept.ok());
  EXPECT_LT(angle_between(turn(kept->clip), Quat::Identity()), 1e-3);
}

// Captures of CMU keep the joints between hips and thighs turned from the reference pose. Would
// fail if hips, and all above them, came to lie 11 mm lower over the legs than they do in the
// target.
TEST(Retarget, ThighsHangBelowTheHipsAsInTheTargetsMotion) {
  const Clip walk = lively_clip(human_skeleton());
  Skeleton rig;
  const Skeleton human = human_skeleton();
  for (int j = 0; j < human.joint_count(); ++j) {
    const std::string& name = human.names[at(j)];
    int parent = human.parents[at(j)];
    if (parent >= 0) parent = rig.find(human.names[at(parent)]);
    if (name.ends_with("UpLeg")) {
      parent = rig.add(name.substr(0, 1) + "HipJoint", parent, human.reference[0]);
    }
    rig.add(name, parent, human.reference[at(j)], human.end_sites[at(j)] != 0);
  }
  // Turned in the motion alone.
  Clip target = lively_clip(posed(rig, "LHipJoint", from_rotation_vector(Vec3(-0.2, 0, 0))));
  target.skeleton = rig;
  const auto result = transfer(walk, target);
  ASSERT_TRUE(result.ok());
  const auto below = [&](const Clip& clip, int f, const char* thigh) {
    const Quat hips = clip.frame_orientations(f)[0].cast<double>();
    const auto places = clip.frame_positions(f);
    return Vec3(hips.conjugate() * (places[at(rig.find(thigh))] - places[0]).cast<double>());
  };
  Vec3 mean = Vec3::Zero();
  for (int f = 0; f < target.frame_count(); ++f) mean += below(target, f, "LeftUpLeg");
  mean /= target.frame_count();
  for (const int f : {0, 13, 39}) {
    EXPECT_LT((below(result->clip, f, "LeftUpLeg") - mean).norm(), 2e-3);
  }
}

// Would fail if feet of a body that lies, which are low in any pose, were taken for feet that
// stand: a take that ends in a fall had bodies whose toes pointed down.
TEST(Retarget, AFallAfterAWalkLeavesTheStance) {
  const Skeleton human = human_skeleton();
  Skeleton folded = human;
  for (const char* name : {"LeftUpLeg", "RightUpLeg"}) {
    folded = posed(folded, name, from_rotation_vector(Vec3(3, 0, 0)));
  }
  Clip walk = lively_clip(human, 60), fall = lively_clip(human, 120);
  for (int f = 60; f < 120; ++f) {
    Skeleton lying = human;
    for (const char* name : {"LeftFoot", "RightFoot"}) {
      lying = posed(lying, name, from_rotation_vector(Vec3(1, 0, 0)));
    }
    lying = posed(lying, human.names[0], from_rotation_vector(Vec3(-1.5, 0, 0)));
    for (Transform& joint : lying.reference) joint.position.y() -= human.reference[0].position.y();
    fall.set_pose(f, lying.reference);
  }
  walk.skeleton = fall.skeleton = folded;
  const RoleMap roles = find_roles(folded);
  const auto of_walk = retarget::find_stance(walk, roles, std::nullopt);
  const auto of_fall = retarget::find_stance(fall, roles, std::nullopt);
  ASSERT_TRUE(of_walk.ok() && of_fall.ok());
  for (const char* name : {"LeftFoot", "RightFoot"}) {
    const auto foot = at(human.find(name));
    EXPECT_LT(angle_between(of_walk->pose[foot].orientation, of_fall->pose[foot].orientation), 0.1);
  }
}

// A reference pose that does not stand and whose head nods, which no bone shows. Would fail if that
// nod were how the head is held: all that is brought onto others hangs its head.
TEST(Retarget, AHeadThatNodsInTheReferencePoseLooksAhead) {
  const Skeleton human = human_skeleton();
  Skeleton folded = human;
  for (const char* name : {"LeftUpLeg", "RightUpLeg"}) {
    folded = posed(folded, name, from_rotation_vector(Vec3(3, 0, 0)));
  }
  Clip walk = lively_clip(human, 60);
  const auto head = at(human.find("Head"));
  const auto looks_up = [&](const Skeleton& reference) {
    walk.skeleton = reference;
    const auto stance = retarget::find_stance(walk, find_roles(reference), std::nullopt);
    EXPECT_TRUE(stance.ok());
    double sum = 0;
    for (int f = 0; f < walk.frame_count(); ++f) {
      const Quat now = walk.frame_orientations(f)[head].cast<double>();
      sum += (now * (stance->pose[head].orientation.conjugate() * Vec3::UnitZ())).y();
    }
    return sum / walk.frame_count();
  };
  EXPECT_NEAR(looks_up(folded), 0, 0.2);
  for (const double nod : {-0.9, 0.9}) {
    EXPECT_NEAR(looks_up(posed(folded, "Head", from_rotation_vector(Vec3(nod, 0, 0)))), 0, 0.2);
  }
}

}  // namespace
}  // namespace krok
