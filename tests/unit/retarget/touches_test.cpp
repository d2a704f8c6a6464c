// If these fail, hands of a retargeted handstand slide or hover, clasped hands part, or a motion
// that touches nothing is bent towards something.

#include "retarget/touches.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/retarget/actors.h"

namespace krok {
namespace {

using namespace test;

// A human with `longer` arms on broad or narrow shoulders.
Skeleton with_arms(double longer, double height) {
  Skeleton skeleton = human_skeleton(height);
  for (const std::string side : {"Left", "Right"}) {
    const double outwards = side == "Left" ? 1 : -1;
    for (const std::string part : {"Arm", "ForeArm", "Hand", "Hand_end"}) {
      Vec3& place = skeleton.reference[at(skeleton.find(side + part))].position;
      place.x() = outwards * (0.09 + longer * (std::abs(place.x()) - 0.05));
    }
  }
  return with_other_axes(skeleton, 5);
}

Skeleton long_armed() {
  return with_arms(1.25, 1.6);
}

// A pose of human_skeleton(): turns of joints about the axes of the world in the T-pose.
struct Turned {
  std::string joint;
  Vec3 turn;
};

// From the T-pose into a pose, held there, and back: a second each, the whole body turned by
// `hips` and with the lowest joint of the pose on the ground.
Clip into_pose(const std::vector<Turned>& turns, const Vec3& hips) {
  Clip clip;
  clip.skeleton = human_skeleton();
  clip.rate = 60;
  clip.resize(180);
  const auto& skeleton = clip.skeleton;
  std::vector<Transform> local(skeleton.names.size()), world(skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    const double u = std::clamp(std::min(f / 60.0, (179 - f) / 60.0), 0.0, 1.0);
    const double part = u * u * (3 - 2 * u);
    for (int j = 0; j < skeleton.joint_count(); ++j) local[at(j)] = skeleton.reference_local(j);
    for (const Turned& turned : turns) {
      local[at(skeleton.find(turned.joint))].orientation = from_rotation_vector(part * turned.turn);
    }
    local[0].orientation = from_rotation_vector(part * hips);
    local_to_world(skeleton.parents, local, world);
    double lowest = 1e9;
    for (const Transform& joint : world) lowest = std::min(lowest, joint.position.y());
    for (Transform& joint : world) joint.position.y() -= lowest - 0.014;
    clip.set_pose(f, world);
  }
  return clip;
}

Vec3 place(const Clip& clip, int frame, const std::string& joint) {
  return clip.frame_positions(frame)[at(clip.skeleton.find(joint))].cast<double>();
}

// Both hands before the chest.
Clip clasping() {
  return into_pose({{"LeftArm", Vec3(0, -1.3, 0)},
                    {"RightArm", Vec3(0, 1.3, 0)},
                    {"LeftForeArm", Vec3(0, -1.3, 0)},
                    {"RightForeArm", Vec3(0, 1.3, 0)}},
                   Vec3::Zero());
}

// The middle of a palm.
Vec3 palm(const Clip& clip, int frame, const std::string& hand) {
  return 0.5 * (place(clip, frame, hand) + place(clip, frame, hand + "_end"));
}

double largest_parting(const Clip& source, const Clip& result, double scale) {
  double most = 0;
  for (int f = 62; f < 118; ++f) {
    const Vec3 was = palm(source, f, "RightHand") - palm(source, f, "LeftHand");
    const Vec3 is = palm(result, f, "rig:RightHand") - palm(result, f, "rig:LeftHand");
    most = std::max(most, std::abs(is.norm() - scale * was.norm()));
  }
  return most;
}

TEST(Touches, HandsThatTouchStayAsNear) {
  const Clip source = clasping();
  ASSERT_LT((palm(source, 90, "RightHand") - palm(source, 90, "LeftHand")).norm(), 0.1);
  const auto kept = transfer(source, long_armed());
  const auto free = transfer(source, long_armed(), {.touches = retarget::Touches::free});
  ASSERT_TRUE(kept.ok() && free.ok());
  EXPECT_LT(largest_parting(source, kept->clip, kept->report.scale), 0.01);
  EXPECT_GT(largest_parting(source, free->clip, free->report.scale), 0.05);
  const auto reported = std::ranges::find_if(
      kept->report.contacts, [](const auto& contact) { return contact.on == "right hand"; });
  ASSERT_NE(reported, kept->report.contacts.end());
  EXPECT_LT(reported->apart, 0.01);
  EXPECT_TRUE(free->report.contacts.empty());
}

// Files of a set have the end of a right hand 1.6 m away: taken for its palm, hands that clap were
// 0.6 m apart, and those of a cartwheel slid by 0.2 m/s.
TEST(Touches, EndsFarFromTheirHandsAreNoHands) {
  const Clip source = clasping();
  Skeleton target = long_armed();
  Vec3& end = target.reference[at(target.find("rig:RightHand_end"))].position;
  end = target.reference[at(target.find("rig:RightHand"))].position + Vec3(1.6, 0, 0);
  const auto made = transfer(source, target);
  ASSERT_TRUE(made.ok());
  const auto apart = [](const Clip& clip, const std::string& rig) {
    return (place(clip, 90, rig + "RightHand") - place(clip, 90, rig + "LeftHand")).norm();
  };
  EXPECT_NEAR(apart(made->clip, "rig:"), made->report.scale * apart(source, ""), 0.03);
}

// The bent arms of runners, hands beside the pelvis. Would fail if palms above the hip joint were
// on the thigh: arms were pulled straight down, by up to 70 degrees, on actors of other
// proportions.
TEST(Touches, HandsBesideThePelvisAreNotOnTheThigh) {
  int near = 0;
  for (const double back : {0.3, 0.4, 0.5, 0.6}) {
    for (const double bend : {1.2, 1.3, 1.4}) {
      const Vec3 upper = Vec3(-0.2, -std::cos(back), -std::sin(back)).normalized();
      const Quat arm = Quat::FromTwoVectors(Vec3::UnitX(), upper);
      const Vec3 elbow = arm.conjugate() * upper.cross(Vec3(0, -std::sin(back), std::cos(back)));
      const Clip source =
          into_pose({{"LeftArm", rotation_vector(arm)}, {"LeftForeArm", bend * elbow.normalized()}},
                    Vec3::Zero());
      const Vec3 hip = place(source, 90, "LeftUpLeg"), hand = palm(source, 90, "LeftHand");
      if (hand.y() < hip.y()) continue;
      near += (hand - hip).norm() < 0.1 ? 1 : 0;
      const auto made = transfer(source, long_armed());
      ASSERT_TRUE(made.ok());
      EXPECT_TRUE(std::ranges::none_of(
          made->report.contacts, [](const auto& contact) { return contact.on == "left thigh"; }))
          << back << ' ' << bend << ' ' << (hand - hip).norm();
    }
  }
  EXPECT_GT(near, 0);
}

// Upside down on straight arms, hands on the ground.
Clip handstand() {
  return into_pose({{"LeftArm", Vec3(0, 0, 1.5)}, {"RightArm", Vec3(0, 0, -1.5)}}, Vec3(3.0, 0, 0));
}

TEST(Touches, HandsOfAHandstandNeitherSlideNorHover) {
  const Clip source = handstand();
  const auto kept = transfer(source, long_armed());
  const auto free = transfer(source, long_armed(), {.touches = retarget::Touches::free});
  ASSERT_TRUE(kept.ok() && free.ok());
  const double scale = kept->report.scale;
  double hovers = 0, hovered = 0, slides = 0;
  for (int f = 62; f < 118; ++f) {
    for (const std::string hand : {"LeftHand", "RightHand"}) {
      const double wanted = scale * palm(source, f, hand).y();
      hovers = std::max(hovers, std::abs(palm(kept->clip, f, "rig:" + hand).y() - wanted));
      hovered = std::max(hovered, std::abs(palm(free->clip, f, "rig:" + hand).y() - wanted));
      Vec3 way = palm(kept->clip, f, "rig:" + hand) - palm(kept->clip, 62, "rig:" + hand);
      way.y() = 0;
      slides = std::max(slides, way.norm());
    }
  }
  EXPECT_LT(hovers, 0.01);
  EXPECT_GT(hovered, 0.1);
  EXPECT_LT(slides, 0.005);
  EXPECT_GT(kept->report.largest_shift, 0.05);
}

// Nobody knew of hands 0.1 m and more in the ground.
TEST(Touches, HandsInTheGroundAreReported) {
  const Clip source = handstand();
  const auto kept = transfer(source, long_armed());
  const auto free = transfer(source, long_armed(), {.touches = retarget::Touches::free});
  ASSERT_TRUE(kept.ok() && free.ok());
  EXPECT_LT(kept->report.largest_depth, 0.02);
  EXPECT_GT(free->report.largest_depth, 0.1);
  EXPECT_EQ(free->clip.skeleton.names[at(free->report.largest_depth_joint)].find("rig:"), 0u);
  EXPECT_NEAR(free->report.largest_depth_time, 1.5, 0.6);
}

// Would fail if a body that lies hovered by as much as its ankles are higher than the source's.
TEST(Touches, WhoLiesIsNotRaisedForTheAnkles) {
  constexpr double kHigher = 0.08;
  Skeleton high = human_skeleton();
  for (int j = 0; j < high.joint_count(); ++j) {
    if (high.names[at(j)].find("Toe") == std::string::npos) {
      high.reference[at(j)].position.y() += kHigher;
    }
  }
  const Clip source = into_pose({}, Vec3(-1.5, 0, 0));
  const auto result = transfer(source, with_other_axes(high, 5));
  ASSERT_TRUE(result.ok());
  const auto higher = [&](int frame) {
    return place(result->clip, frame, "rig:Hips").y() -
           result->report.scale * place(source, frame, "Hips").y();
  };
  EXPECT_NEAR(higher(0), kHigher, 0.02);
  for (int f = 62; f < 118; ++f) EXPECT_NEAR(higher(f), 0, 0.01) << f;
}

// Would fail if hands of short arms pulled someone who slides over the ground on the seat into it.
TEST(Touches, HandsDoNotPullTheSeatIntoTheGround) {
  Clip source = into_pose({{"LeftUpLeg", Vec3(-2.35, 0, 0)},
                           {"RightUpLeg", Vec3(-2.35, 0, 0)},
                           {"LeftLeg", Vec3(2.35, 0, 0)},
                           {"RightLeg", Vec3(2.35, 0, 0)},
                           {"LeftArm", Vec3(0, 0, -1.5)},
                           {"RightArm", Vec3(0, 0, 1.5)}},
                          Vec3::Zero());
  std::vector<Transform> pose(source.skeleton.names.size());
  for (int f = 0; f < source.frame_count(); ++f) {
    source.get_pose(f, pose);
    for (Transform& joint : pose) joint.position.z() += 0.45 * f / source.rate;
    source.set_pose(f, pose);
  }
  const auto result = transfer(source, with_arms(0.6, 1.75));
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(std::ranges::any_of(result->report.contacts,
                                  [](const auto& contact) { return contact.part == "left hand"; }));
  EXPECT_GT(result->report.largest_shift, 0.05);
  for (int f = 62; f < 118; ++f) {
    EXPECT_GT(place(result->clip, f, "rig:LeftUpLeg").y(), 0.1) << f;
  }
}

TEST(Touches, AMotionThatTouchesNothingKeepsItsRotations) {
  const Clip source =
      into_pose({{"LeftArm", Vec3(0, 0, 0.8)}, {"Spine1", Vec3(0.2, 0.3, 0)}}, Vec3::Zero());
  const auto kept = transfer(source, long_armed());
  const auto free = transfer(source, long_armed(), {.touches = retarget::Touches::free});
  ASSERT_TRUE(kept.ok() && free.ok());
  EXPECT_LT(largest_distance(kept->clip, free->clip), 1e-6);
}

TEST(FindTouch, WeighsStaysAndFadesBesideThem) {
  std::vector<double> distance(100, 1.0), speed(100, 0.0);
  std::fill(distance.begin() + 40, distance.begin() + 60, 0.05);
  distance[80] = 0.05;  // too short
  const auto touch = retarget::find_touch(distance, speed, {0.1, 0.3, 0.5, 0.1}, 30);
  ASSERT_EQ(touch.stays.size(), 1u);
  EXPECT_EQ(touch.stays[0].first, 40);
  EXPECT_EQ(touch.stays[0].last, 59);
  for (int f = 40; f < 60; ++f) EXPECT_NEAR(touch.weight[at(f)], 1, 1e-12) << f;
  EXPECT_EQ(touch.weight[20], 0);
  EXPECT_EQ(touch.weight[80], 0);
  std::fill(speed.begin(), speed.end(), 1.0);  // passes by
  EXPECT_TRUE(retarget::find_touch(distance, speed, {0.1, 0.3, 0.5, 0.1}, 30).stays.empty());
  EXPECT_TRUE(retarget::find_touch({}, {}, {0.1, 0.3, 0.5, 0.1}, 30).weight.empty());
}

TEST(BesideLine, IsNearestToTheLine) {
  const auto beside = retarget::beside_line({1, 2, 0}, {0, 0, 0}, {4, 0, 0});
  EXPECT_DOUBLE_EQ(beside.along, 0.25);
  EXPECT_LT((beside.off - Vec3(0, 2, 0)).norm(), 1e-12);
  EXPECT_EQ(retarget::beside_line({9, 0, 0}, {0, 0, 0}, {4, 0, 0}).along, 1);
  EXPECT_EQ(retarget::beside_line({9, 0, 0}, {4, 0, 0}, {4, 0, 0}).along, 0);  // no line
}

}  // namespace
}  // namespace krok
