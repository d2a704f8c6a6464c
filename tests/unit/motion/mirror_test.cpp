// If these fail, a mirrored figure limps, twists its joints, or is not mirrored at all.

#include "motion/mirror.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "support/test_scenes.h"
#include "unit/motion/joint_place.h"

namespace krok {
namespace {

using test::joint_place;

Vec3 image(const Vec3& p) {
  return {-p.x(), p.y(), p.z()};
}

MirrorPairs pairs_of(const Skeleton& skeleton) {
  return find_mirror_pairs(skeleton, find_roles(skeleton));
}

// Every joint of the mirrored motion stands where its partner's image stands.
void expect_mirrored(const Clip& clip, const Clip& mirrored, const MirrorPairs& pairs,
                     double within) {
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      const int other = pairs.partners[static_cast<std::size_t>(j)];
      ASSERT_GE(other, 0) << clip.skeleton.names[static_cast<std::size_t>(j)];
      EXPECT_LT((joint_place(mirrored, f, j) - image(joint_place(clip, f, other))).norm(), within)
          << clip.skeleton.names[static_cast<std::size_t>(j)] << ", frame " << f;
    }
  }
}

double largest_angle(const Clip& a, const Clip& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.orientations.size(); ++i) {
    most = std::max(
        most, angle_between(a.orientations[i].cast<double>(), b.orientations[i].cast<double>()));
  }
  return most;
}

double largest_distance(const Clip& a, const Clip& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    most = std::max<double>(most, (a.positions[i] - b.positions[i]).norm());
  }
  return most;
}

void expect_twice_is_nothing(const Clip& clip, const MirrorPairs& pairs) {
  const Clip twice = mirror(mirror(clip, pairs), pairs);
  EXPECT_LT(largest_angle(twice, clip), 2e-6);
  EXPECT_LT(largest_distance(twice, clip), 5e-6);
}

TEST(MirrorPairs, OfAHumanByRolesAndNames) {
  const Skeleton skeleton = test::human_skeleton();
  const MirrorPairs pairs = pairs_of(skeleton);
  EXPECT_TRUE(pairs.unpaired().empty());
  EXPECT_EQ(pairs.plane, 0);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string& name = skeleton.names[static_cast<std::size_t>(j)];
    std::string other = name;
    if (name.starts_with("Left")) other = "Right" + name.substr(4);
    if (name.starts_with("Right")) other = "Left" + name.substr(5);
    EXPECT_EQ(skeleton.names[static_cast<std::size_t>(pairs.partners[static_cast<std::size_t>(j)])],
              other);
  }
}

TEST(MirrorPairs, NamesNeedNotBeAlikeOnBothSides) {
  Skeleton skeleton = test::human_skeleton();
  const auto rename = [&](const char* from, const char* to) {
    skeleton.names[static_cast<std::size_t>(skeleton.find(from))] = to;
  };
  rename("LeftForeArm", "elbow_l");
  rename("LeftHand_end", "tip");
  rename("RightToeBase_end", "nub");
  const MirrorPairs pairs = pairs_of(skeleton);
  EXPECT_TRUE(pairs.unpaired().empty());
  const auto partner = [&](const char* name) {
    const auto j = static_cast<std::size_t>(skeleton.find(name));
    return skeleton.names[static_cast<std::size_t>(pairs.partners[j])];
  };
  EXPECT_EQ(partner("elbow_l"), "RightForeArm");
  EXPECT_EQ(partner("tip"), "RightHand_end");
  EXPECT_EQ(partner("LeftToeBase_end"), "nub");
}

TEST(MirrorPairs, ByPlacesWhereNamesTellNothing) {
  Skeleton skeleton = test::human_skeleton();
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    skeleton.names[j] = "joint" + std::to_string(j);
  }
  EXPECT_TRUE(pairs_of(skeleton).unpaired().empty());
  RoleMap nothing;
  nothing.roles.assign(skeleton.names.size(), Role::none);
  const MirrorPairs pairs = find_mirror_pairs(skeleton, nothing);
  EXPECT_TRUE(pairs.unpaired().empty());
  EXPECT_EQ(pairs.partners, pairs_of(test::human_skeleton()).partners);
}

// MakeHuman's faces: joints whose names differ from their parents' by signs alone, at places that
// the reference pose has turned.
TEST(MirrorPairs, NamesThatDifferBySignsAlone) {
  Skeleton skeleton = test::human_skeleton();
  const int head = skeleton.find("Head");
  const Vec3 at_head = skeleton.reference[static_cast<std::size_t>(head)].position;
  std::vector<int> brows;
  for (const double x : {0.03, -0.03}) {
    const std::string side = x > 0 ? ".l" : ".r";
    const int root = skeleton.add("__brow" + side, head, {at_head + Vec3(x, 0.1, 0.05)});
    brows.push_back(
        skeleton.add("brow" + side, root, {at_head + Vec3(2 * x, x > 0 ? 0.1 : 0.3, 0)}));
  }
  const MirrorPairs pairs = pairs_of(skeleton);
  EXPECT_TRUE(pairs.unpaired().empty());
  EXPECT_EQ(pairs.partners[static_cast<std::size_t>(brows[0])], brows[1]);
}

TEST(MirrorPairs, WhatOneSideAloneHasIsUnpaired) {
  Skeleton skeleton = test::human_skeleton();
  const int hand = skeleton.find("RightHand");
  const int sword = skeleton.add("Sword", hand, {Vec3(-0.9, 1.4, 0.3), Quat::Identity()});
  const MirrorPairs pairs = pairs_of(skeleton);
  EXPECT_EQ(pairs.unpaired(), std::vector<int>{sword});
}

TEST(MirrorPairs, AHeadHeldAslantIsStillOfTheMiddle) {
  Skeleton skeleton = test::human_skeleton();
  const auto head = static_cast<std::size_t>(skeleton.find("Head"));
  const int jaw = skeleton.add("Jaw", static_cast<int>(head),
                               {skeleton.reference[head].position + Vec3(0.06, 0.02, 0.05)});
  const MirrorPairs pairs = pairs_of(skeleton);
  EXPECT_EQ(pairs.partners[static_cast<std::size_t>(jaw)], jaw);
  expect_mirrored(test::swinging_clip(skeleton, 3, 30),
                  mirror(test::swinging_clip(skeleton, 3, 30), pairs), pairs, 2e-6);
}

// Would fail if a tail that the reference pose swings to a side were no part of the middle, or if
// pairs depended on which way the reference pose faces: both lost their motion.
TEST(MirrorPairs, TailsAreOfTheMiddleWhicheverWayTheReferencePoseFaces) {
  for (const double angle : {0.0, 0.4, kPi / 2, 2.5}) {
    Skeleton skeleton = test::human_skeleton();
    const Vec3 hips = skeleton.reference[0].position;
    skeleton.add("Tail", 0, {hips + Vec3(0.05, 0, -0.1)});
    skeleton.add("Tail1", skeleton.find("Tail"), {hips + Vec3(0.1, -0.1, -0.2)});
    const MirrorPairs straight = find_mirror_pairs(skeleton, find_roles(skeleton));
    EXPECT_TRUE(straight.unpaired().empty());
    for (Transform& joint : skeleton.reference) {
      joint.position = from_rotation_vector(Vec3(0, angle, 0)) * joint.position;
    }
    EXPECT_EQ(find_mirror_pairs(skeleton, find_roles(skeleton)).partners, straight.partners)
        << angle;
  }
}

TEST(Mirror, IsTheImageOfASymmetricActor) {
  const Clip clip = test::swinging_clip(test::human_skeleton(), 12, 30);
  const MirrorPairs pairs = pairs_of(clip.skeleton);
  const Clip mirrored = mirror(clip, pairs);
  expect_mirrored(clip, mirrored, pairs, 2e-6);
  expect_twice_is_nothing(clip, pairs);
  EXPECT_TRUE(check(mirrored).ok());
}

TEST(Mirror, JointsOwnAxesDoNotMatter) {
  const Skeleton plain = test::human_skeleton();
  const Clip clip = test::swinging_clip(test::with_turned_joints(plain), 12, 30);
  const MirrorPairs pairs = pairs_of(clip.skeleton);
  const Clip mirrored = mirror(clip, pairs);
  expect_mirrored(clip, mirrored, pairs, 2e-6);
  expect_twice_is_nothing(clip, pairs);
  // The turn of each joint from the reference pose is its partner's, mirrored.
  for (int j = 0; j < clip.joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const auto other = static_cast<std::size_t>(pairs.partners[at]);
    const Quat mine = mirrored.frame_orientations(7)[at].cast<double>() *
                      clip.skeleton.reference[at].orientation.conjugate();
    const Quat theirs = clip.frame_orientations(7)[other].cast<double>() *
                        clip.skeleton.reference[other].orientation.conjugate();
    const Quat expected(theirs.w(), theirs.x(), -theirs.y(), -theirs.z());
    EXPECT_LT(angle_between(mine, expected), 2e-6);
  }
}

// One arm of the reference pose hangs down, the other points aside: the bones of the result are
// images of each other all the same.
TEST(Mirror, ALopsidedReferencePoseDoesNotMatter) {
  Skeleton skeleton = test::human_skeleton();
  const int arm = skeleton.find("LeftArm");
  const Transform at_arm{skeleton.reference[static_cast<std::size_t>(arm)].position,
                         Quat::Identity()};
  const Transform down =
      at_arm * Transform{Vec3::Zero(), from_rotation_vector(Vec3(0, 0, -1.3))} * at_arm.inverse();
  for (const char* name : {"LeftForeArm", "LeftHand", "LeftHand_end"}) {
    Transform& joint = skeleton.reference[static_cast<std::size_t>(skeleton.find(name))];
    joint.position = down * joint.position;
  }
  const Clip clip = test::swinging_clip(skeleton, 10, 30);
  const MirrorPairs pairs = pairs_of(skeleton);
  expect_mirrored(clip, mirror(clip, pairs), pairs, 2e-6);
  expect_twice_is_nothing(clip, pairs);
}

// The reference pose's trunk is turned a quarter round above the hips, or above the chest, as in
// some exporters' zero poses; no frame is. If this fails, mirrored spines are twisted half round
// and back again, and blends with them wring the trunk.
TEST(Mirror, ATrunkTwistedInTheReferencePoseIsNotTwistedByMirroring) {
  for (const char* twisted : {"Spine", "Neck"}) {
    Skeleton skeleton = test::human_skeleton();
    const int first = skeleton.find(twisted);
    ASSERT_GE(first, 0);
    Clip clip = test::swinging_clip(skeleton, 12, 30);
    const Transform at_joint{skeleton.reference[static_cast<std::size_t>(first)].position,
                             Quat::Identity()};
    const Transform twist = at_joint *
                            Transform{Vec3::Zero(), from_rotation_vector(Vec3(0, kPi / 2, 0))} *
                            at_joint.inverse();
    for (int j = first; j < skeleton.joint_count(); ++j) {
      int above = j;
      while (above > first) above = skeleton.parents[static_cast<std::size_t>(above)];
      Transform& joint = clip.skeleton.reference[static_cast<std::size_t>(j)];
      if (above == first) joint = twist * joint;
    }
    const MirrorPairs pairs = pairs_of(skeleton);
    const Clip mirrored = mirror(clip, pairs);
    expect_mirrored(clip, mirrored, pairs, 2e-6);
    expect_twice_is_nothing(clip, pairs);
    for (int j = 1; j < clip.joint_count(); ++j) {
      const auto at = static_cast<std::size_t>(j);
      const int parent = clip.skeleton.parents[at];
      if (pairs.partners[at] != j || pairs.partners[static_cast<std::size_t>(parent)] != parent) {
        continue;
      }
      const auto in_parent = [&](const Clip& one) {
        const auto pose = one.frame_orientations(5);
        return Quat(pose[static_cast<std::size_t>(parent)].cast<double>().conjugate() *
                    pose[at].cast<double>());
      };
      EXPECT_LT(angle_between(in_parent(clip), in_parent(mirrored)), 75 * kRadiansPerDegree)
          << clip.skeleton.names[at] << ", twisted above " << twisted;
    }
  }
}

// Left chains along +x and right ones along -x in the reference pose, where all axes are the
// world's, and every frame has the right arm half round about its bones: a convention of some
// exporters. If this fails, mirrored shoulders and arms are half round against all other steps of
// the actor, and blends of both wring them.
TEST(Mirror, ArmsHalfRoundInTheReferencePoseKeepTheirAxes) {
  Clip clip = test::swinging_clip(test::human_skeleton(), 12, 30);
  const Skeleton& skeleton = clip.skeleton;
  std::vector<Transform> pose(skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    for (const char* name : {"RightShoulder", "RightArm", "RightForeArm", "RightHand"}) {
      Quat& turned = pose[static_cast<std::size_t>(skeleton.find(name))].orientation;
      turned = turned * Quat(0, 1, 0, 0);
    }
    clip.set_pose(f, pose);
  }
  const MirrorPairs pairs = pairs_of(skeleton);
  const Clip mirrored = mirror(clip, pairs);
  expect_mirrored(clip, mirrored, pairs, 2e-6);
  expect_twice_is_nothing(clip, pairs);
  for (const char* name :
       {"LeftShoulder", "LeftArm", "LeftForeArm", "RightShoulder", "RightArm", "RightForeArm"}) {
    const int joint = skeleton.find(name);
    const auto in_parent = [&](const Clip& one) {
      return local_motion(one).at(joint, 5).orientation;
    };
    EXPECT_LT(angle_between(in_parent(clip), in_parent(mirrored)), 75 * kRadiansPerDegree) << name;
  }
}

// Spine and neck that the motion has turned about their bones by any angle against the reference
// pose, as where that lies. Would fail if they came out turned by far in their parents: waists and
// necks of skins were wrung. (The spine of this motion swings by far itself.)
TEST(Mirror, ATrunkAnyWayRoundIsNotWrung) {
  const Skeleton skeleton = test::human_skeleton();
  const MirrorPairs pairs = pairs_of(skeleton);
  for (int degrees = 0; degrees <= 180; degrees += 12) {
    Clip clip = test::swinging_clip(skeleton, 12, 30);
    const Quat about = from_rotation_vector(Vec3(0, degrees * kRadiansPerDegree, 0));
    for (const char* name : {"Spine", "Neck"}) {
      const auto joint = static_cast<std::size_t>(skeleton.find(name));
      for (int f = 0; f < clip.frame_count(); ++f) {
        Quatf& turned = clip.frame_orientations(f)[joint];
        turned = (turned.cast<double>() * about).normalized().cast<float>();
      }
    }
    expect_twice_is_nothing(clip, pairs);
    const Clip mirrored = mirror(clip, pairs);
    for (const char* name : {"Spine", "Neck"}) {
      EXPECT_LT(angle_between(local_motion(clip).at(skeleton.find(name), 6).orientation,
                              local_motion(mirrored).at(skeleton.find(name), 6).orientation),
                110 * kRadiansPerDegree)
          << name << degrees;
    }
  }
}

// A boxer looks aside all the time, another glances far aside in the frame in the middle alone.
// Would fail if the head kept the side that it looks to, as one of a twisted reference pose does.
TEST(Mirror, AHeadThatLooksAsideLooksToTheOtherSide) {
  const Skeleton skeleton = test::human_skeleton();
  const MirrorPairs pairs = pairs_of(skeleton);
  const auto head = static_cast<std::size_t>(skeleton.find("Head"));
  for (const auto& [degrees, first, last] : {std::tuple(48, 0, 12), std::tuple(80, 5, 7)}) {
    Clip clip;
    clip.skeleton = skeleton;
    clip.resize(12);
    const Quat about = from_rotation_vector(Vec3(0, degrees * kRadiansPerDegree, 0));
    for (int f = 0; f < clip.frame_count(); ++f) {
      clip.set_pose(f, skeleton.reference);
      if (f >= first && f < last) clip.frame_orientations(f)[head] = about.cast<float>();
    }
    const Clip mirrored = mirror(clip, pairs);
    EXPECT_LT(angle_between(mirrored.frame_orientations(6)[head].cast<double>(), about.conjugate()),
              0.01)
        << degrees;
  }
}

// Thighs that are turned about their bones by any angle against each other. Would fail if the first
// turn that is better were taken, not the best one: thighs would be a quarter round, and mirrored
// again something else.
TEST(Mirror, ThighsAnyWayRoundKeepTheirAxes) {
  const Skeleton skeleton = test::human_skeleton();
  const MirrorPairs pairs = pairs_of(skeleton);
  const int thigh = skeleton.find("RightUpLeg");
  for (int degrees = 0; degrees <= 180; degrees += 4) {
    Clip clip = test::swinging_clip(skeleton, 12, 30);
    const Quat about = from_rotation_vector(Vec3(0, degrees * kRadiansPerDegree, 0));
    for (int f = 0; f < clip.frame_count(); ++f) {
      for (const char* name : {"RightUpLeg", "RightLeg"}) {
        Quatf& turned = clip.frame_orientations(f)[static_cast<std::size_t>(skeleton.find(name))];
        turned = (turned.cast<double>() * about).normalized().cast<float>();
      }
    }
    expect_twice_is_nothing(clip, pairs);
    const Clip mirrored = mirror(clip, pairs);
    EXPECT_LT(angle_between(local_motion(clip).at(thigh, 5).orientation,
                            local_motion(mirrored).at(thigh, 5).orientation),
              125 * kRadiansPerDegree)
        << degrees;
  }
}

TEST(Mirror, AActorThatStandsBesideTheOriginInItsReferencePose) {
  Skeleton skeleton = test::human_skeleton();
  const Clip centred = test::swinging_clip(skeleton, 6, 30);
  for (Transform& joint : skeleton.reference) joint.position.x() += 0.8;
  Clip clip = centred;
  clip.skeleton = skeleton;
  const MirrorPairs pairs = pairs_of(skeleton);
  EXPECT_NEAR(pairs.plane, 0.8, 1e-12);
  // The reference pose says nothing of where the motion is.
  EXPECT_LT(largest_distance(mirror(clip, pairs), mirror(centred, pairs_of(centred.skeleton))),
            1e-6);
  expect_twice_is_nothing(clip, pairs);
}

// A figure with a longer left shank and a hand set at another angle has them on the right in the
// mirror, in the skeleton as well.
TEST(Mirror, TheFigureIsMirroredWithTheMotion) {
  Skeleton skeleton = test::with_turned_joints(test::human_skeleton());
  const auto move = [&](const char* name, const Vec3& by) {
    skeleton.reference[static_cast<std::size_t>(skeleton.find(name))].position += by;
  };
  move("LeftFoot", Vec3(0, -0.05, 0));
  move("RightHand", Vec3(0, 0.02, 0.03));
  const Clip clip = test::swinging_clip(skeleton, 5, 30);
  const MirrorPairs pairs = pairs_of(skeleton);
  const Clip mirrored = mirror(clip, pairs);
  expect_mirrored(clip, mirrored, pairs, 2e-6);
  expect_twice_is_nothing(clip, pairs);
  const LocalMotion motion = local_motion(mirrored);
  for (int j = 1; j < clip.joint_count(); ++j) {
    EXPECT_LT((motion.at(j, 3).position - mirrored.skeleton.reference_local(j).position).norm(),
              2e-6)
        << skeleton.names[static_cast<std::size_t>(j)];
  }
  const Skeleton twice = mirror(mirrored, pairs).skeleton;
  for (int j = 0; j < clip.joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    EXPECT_LT((twice.reference[at].position - skeleton.reference[at].position).norm(), 1e-6);
  }
}

TEST(Mirror, JointsThatMoveInTheirParentsAndThoseWithoutPartner) {
  Skeleton skeleton = test::human_skeleton();
  const int sword = skeleton.add("Sword", skeleton.find("RightHand"),
                                 {Vec3(-0.9, 1.4, 0.3), from_rotation_vector(Vec3(1, 0, 2))});
  Clip clip = test::swinging_clip(skeleton, 8, 30);
  LocalMotion motion = local_motion(clip);
  for (int f = 0; f < 8; ++f) {
    for (const char* name : {"LeftHand", "Spine1"}) {
      Transform local = motion.at(skeleton.find(name), f);
      local.position += 0.02 * f * Vec3(1, 0.5, 0.2);
      motion.set(skeleton.find(name), f, local);
    }
  }
  set_local_motion(motion, clip);
  const MirrorPairs pairs = pairs_of(skeleton);
  const Clip mirrored = mirror(clip, pairs);
  for (const char* name : {"RightHand", "Spine1", "Head"}) {
    const int j = skeleton.find(name);
    const int other = pairs.partners[static_cast<std::size_t>(j)];
    EXPECT_LT((joint_place(mirrored, 7, j) - image(joint_place(clip, 7, other))).norm(), 2e-6)
        << name;
  }
  const LocalMotion after = local_motion(mirrored);
  EXPECT_LT(angle_between(after.at(sword, 5).orientation, motion.at(sword, 5).orientation), 2e-6);
  expect_twice_is_nothing(clip, pairs);
}

// Some exporters' reference poses have the face's joints twisted against what all frames have.
TEST(Mirror, FacesTwistedInTheReferencePoseStayFaces) {
  Skeleton skeleton = test::human_skeleton();
  const int head = skeleton.find("Head");
  const Vec3 place = skeleton.reference[static_cast<std::size_t>(head)].position;
  const int jaw = skeleton.add("JawRoot", head, {place + Vec3(0, 0, 0.05), Quat::Identity()});
  const int chin = skeleton.add("Tongue", jaw, {place + Vec3(0, 0, 0.1), Quat::Identity()});
  Clip clip = test::swinging_clip(skeleton, 8, 30);
  LocalMotion motion = local_motion(clip);
  for (int f = 0; f < 8; ++f) {
    Transform local = motion.at(jaw, f);
    local.orientation = from_rotation_vector(Vec3(0, 0, kPi / 2));
    motion.set(jaw, f, local);
    local = motion.at(chin, f);
    local.orientation = Quat::Identity();
    motion.set(chin, f, local);
  }
  set_local_motion(motion, clip);
  const MirrorPairs pairs = pairs_of(skeleton);
  ASSERT_EQ(pairs.partners[static_cast<std::size_t>(jaw)], jaw);
  const LocalMotion after = local_motion(mirror(clip, pairs));
  for (int f = 0; f < 8; ++f) {
    EXPECT_LT(angle_between(after.at(jaw, f).orientation, motion.at(jaw, f).orientation), 1e-5);
    EXPECT_LT(angle_between(after.at(chin, f).orientation, motion.at(chin, f).orientation), 1e-5);
  }
  // What moves is no twist of the reference pose.
  for (int f = 0; f < 8; ++f) {
    Transform local = motion.at(jaw, f);
    local.orientation = from_rotation_vector(Vec3(0, 0, kPi / 2 + 0.1 * f));
    motion.set(jaw, f, local);
  }
  set_local_motion(motion, clip);
  const LocalMotion moved = local_motion(mirror(clip, pairs));
  EXPECT_LT(
      angle_between(moved.at(jaw, 3).orientation, from_rotation_vector(Vec3(0, 0, -kPi / 2 - 0.3))),
      1e-5);
}

// Feet with two toe joints each, nearly in one line, a little different on both sides, with axes of
// their own: what they tell of the foot's twist is little, or nothing, and must be read alike when
// the mirrored motion is mirrored again, as files hold it.
TEST(Mirror, ToesAlmostInLineDoNotTwistTheirFoot) {
  std::uint64_t state = 7;
  const auto random = [&state] {  // in [-1, 1]
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 33) / 0x1p30 - 1;
  };
  const auto some = [&] { return Vec3(random(), random(), random()); };
  const Clip human = test::swinging_human(3);
  double largest = 0;
  for (int round = 0; round < 400; ++round) {
    const double off = std::pow(10, -4 + 2.5 * std::abs(random())), uneven = 0.02 * random();
    Clip clip = human;
    Skeleton& skeleton = clip.skeleton;
    for (const char* name : {"LeftFoot", "RightFoot"}) {
      const int foot = skeleton.find(name);
      Transform own = skeleton.reference[static_cast<std::size_t>(foot)];
      own.orientation = (own.orientation * from_rotation_vector(0.05 * some())).normalized();
      skeleton.reference[static_cast<std::size_t>(foot)] = own;
      for (int child = 0; child < 2; ++child) {
        const Vec3 toe =
            (1 + uneven * random()) * (0.06 + 0.05 * child) * Vec3(0, -0.3, 1) + off * 0.1 * some();
        skeleton.add(std::string(name) + "Toe" + std::to_string(child), foot,
                     own * Transform{toe, from_rotation_vector(0.3 * some())});
      }
    }
    clip.resize(human.frame_count());
    std::vector<Transform> pose(skeleton.names.size());
    for (int f = 0; f < clip.frame_count(); ++f) {
      human.get_pose(f, std::span(pose).first(human.skeleton.names.size()));
      for (std::size_t j = human.skeleton.names.size(); j < pose.size(); ++j) {
        pose[j] = pose[static_cast<std::size_t>(skeleton.parents[j])] *
                  skeleton.reference_local(static_cast<int>(j));
      }
      clip.set_pose(f, pose);
    }
    const MirrorPairs pairs = pairs_of(skeleton);
    ASSERT_TRUE(pairs.unpaired().empty());
    Clip once = mirror(clip, pairs);
    for (Transform& joint : once.skeleton.reference) {
      joint.position = joint.position.cast<float>().cast<double>();
      joint.orientation = joint.orientation.cast<float>().cast<double>().normalized();
    }
    const Clip twice = mirror(once, pairs_of(once.skeleton));
    largest = std::max(largest, largest_angle(twice, clip));
    EXPECT_LT(largest_distance(twice, clip), 1e-5);
  }
  EXPECT_LT(largest, 0.001 * kRadiansPerDegree);
}

TEST(Mirror, FramesMadeWhenAskedForAreTheSame) {
  const Clip clip = test::swinging_human(300);
  const MirrorPairs pairs = pairs_of(clip.skeleton);
  const Clip expected = mirror(clip, pairs);
  const auto source = mirror(frames_of(clip), pairs, 2);
  ASSERT_TRUE(source.ok());
  for (const int jobs : {1, 3}) {
    const Clip made = load(*source, jobs).value();
    EXPECT_TRUE(made.positions == expected.positions);
    EXPECT_TRUE(made.orientations == expected.orientations);
  }
  FrameSource broken = frames_of(clip);
  broken.read = [](auto...) { return Error("test", "is damaged"); };
  EXPECT_EQ(mirror(broken, pairs, 1).error().code, "test");
}

TEST(Mirror, OneJointAndNoFrames) {
  Skeleton single;
  single.add("root", -1, {Vec3(0.1, 1, 0), from_rotation_vector(Vec3(1, 2, 3))});
  const Clip clip = test::swinging_clip(single, 4, 30);
  expect_twice_is_nothing(clip, pairs_of(single));
  const Clip empty = test::swinging_clip(test::human_skeleton(), 0, 30);
  EXPECT_EQ(mirror(empty, pairs_of(empty.skeleton)).frame_count(), 0);
}

}  // namespace
}  // namespace krok
