// If these fail, eyes miss what they look at, leave their sockets, or the head turns as much, as
// soon or otherwise than people's.

#include "ik/gaze.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/index.h"
#include "math/quaternion.h"
#include "roles/body_frame.h"
#include "support/human_skeleton.h"

namespace krok::ik {
namespace {

constexpr double kDegree = kRadiansPerDegree;
constexpr int kRate = 200;

const std::vector<Character::Eye> kEyes = {{"left", "Head", Vec3f(0.031f, 1.63f, 0.09f), {}},
                                           {"right", "Head", Vec3f(-0.031f, 1.63f, 0.09f), {}}};

Clip standing(double seconds) {
  Clip clip;
  clip.skeleton = krok::test::human_skeleton();
  clip.rate = kRate;
  clip.resize(static_cast<int>(seconds * kRate) + 1);
  for (int f = 0; f < clip.frame_count(); ++f) clip.set_pose(f, clip.skeleton.reference);
  return clip;
}

// 5 m away from between the eyes.
Vec3 target_at(double yaw, double pitch = 0) {
  return Vec3(0, 1.63, 0.09) + 5 * Vec3(std::sin(yaw) * std::cos(pitch), std::sin(pitch),
                                        std::cos(yaw) * std::cos(pitch));
}

GazeMotion gaze(const Clip& clip, const std::vector<GazeTarget>& targets,
                const std::vector<Character::Eye>& eyes = kEyes) {
  const auto found = gaze_eyes(eyes, clip.skeleton, clip.skeleton);
  EXPECT_TRUE(found.ok());
  auto made = apply_gaze(clip, *found, targets, find_roles(clip.skeleton));
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message);
  EXPECT_TRUE(check(made->clip).ok());
  return *std::move(made);
}

Quat orientation(const Clip& clip, int frame, const char* joint) {
  return clip.frame_orientations(frame)[at(clip.skeleton.find(joint))].cast<double>();
}

double head_angle(const Clip& clip, int frame) {
  return angle_between(Quat::Identity(), orientation(clip, frame, "Head"));
}

// By how much an eye, which looks along +Z, misses a point.
double miss(const Clip& clip, int frame, const char* eye, const Vec3& point) {
  const Vec3 place = clip.frame_positions(frame)[at(clip.skeleton.find(eye))].cast<double>();
  const Vec3 way = (point - place).normalized();
  return std::acos(std::min(1.0, way.dot(orientation(clip, frame, eye) * Vec3::UnitZ())));
}

// Yaw and pitch of an eye in the head, which is unturned in the reference pose.
Vec2 in_head(const Clip& clip, int frame, const char* eye) {
  const Vec3 way = orientation(clip, frame, "Head").conjugate() *
                   (orientation(clip, frame, eye) * Vec3::UnitZ());
  return {std::atan2(way.x(), way.z()) / kDegree, std::asin(way.y()) / kDegree};
}

// Captures keep reference poses that lie on their side: up +X and left +Z there, which is no other
// motion.
TEST(Gaze, DoesNotDependOnHowTheReferencePoseLies) {
  const Clip clip = standing(3);
  const Quat laid(Mat3{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}});  // the reference pose's axes
  Clip lying = clip;
  for (Transform& joint : lying.skeleton.reference) joint.position = laid * joint.position;
  for (auto& turn : lying.orientations) turn = turn * laid.conjugate().cast<float>();
  ASSERT_TRUE(check(lying).ok());
  std::vector<Character::Eye> eyes = kEyes;
  for (Character::Eye& eye : eyes) eye.position = laid.cast<float>() * eye.position;
  const Vec3 point = target_at(35 * kDegree, 10 * kDegree);
  const GazeMotion made = gaze(clip, {{1.0, point}});
  const GazeMotion same = gaze(lying, {{1.0, point}}, eyes);
  const int last = clip.frame_count() - 1;
  EXPECT_LT(miss(same.clip, last, "left_eye", point), 0.01 * kDegree);
  EXPECT_GT(head_angle(made.clip, last), 5 * kDegree);
  for (const int frame : {0, 210, 260, last}) {
    EXPECT_LT(angle_between(orientation(made.clip, frame, "Head"),
                            orientation(same.clip, frame, "Head") * laid),
              1e-5)
        << frame;
    EXPECT_LT(angle_between(orientation(made.clip, frame, "left_eye"),
                            orientation(same.clip, frame, "left_eye")),
              1e-5)
        << frame;
  }
}

// In reference poses of some captures the head is twisted by a quarter turn, which the positions of
// its joint do not show: only that it is turned back through the whole motion.
TEST(Gaze, DoesNotDependOnATwistOfTheHeadInTheReferencePose) {
  const Clip clip = standing(3);
  const std::size_t head = at(clip.skeleton.find("Head"));
  const Quat twist(Eigen::AngleAxisd(kPi / 2, Vec3::UnitY()));
  Clip twisted = clip;
  for (int f = 0; f < clip.frame_count(); ++f) {
    Quatf& turn = twisted.frame_orientations(f)[head];
    turn = turn * twist.conjugate().cast<float>();
  }
  const Skeleton facing = facing_skeleton(twisted, find_roles(twisted.skeleton));
  EXPECT_LT(angle_between(facing.reference[head].orientation, twist.conjugate()), 1e-6);
  // Within a common bow of the head the reference pose decides.
  EXPECT_EQ(facing_skeleton(clip, find_roles(clip.skeleton)).reference[head].orientation.coeffs(),
            clip.skeleton.reference[head].orientation.coeffs());
  std::vector<Character::Eye> eyes = kEyes;
  const Vec3 place = clip.skeleton.reference[head].position;
  for (Character::Eye& eye : eyes) {
    eye.position = (place + twist * Vec3(eye.position.cast<double>() - place)).cast<float>();
  }
  const Vec3 point = target_at(35 * kDegree, 10 * kDegree);
  const GazeMotion made = gaze(clip, {{1.0, point}});
  const GazeMotion same = gaze(twisted, {{1.0, point}}, eyes);
  const int last = clip.frame_count() - 1;
  EXPECT_LT(miss(same.clip, last, "left_eye", point), 0.01 * kDegree);
  EXPECT_LT(angle_between(orientation(made.clip, last, "Head"),
                          orientation(same.clip, last, "Head") * twist),
            1e-5);
}

TEST(Gaze, TheHeadsShareIsThatOfTheTable) {
  // Freedman and Sparks 1997: nothing up to 20 degrees; at 90 the eyes are at 35.
  EXPECT_EQ(head_share(0), 0);
  EXPECT_EQ(head_share(20 * kDegree), 0);
  EXPECT_NEAR(head_share(90 * kDegree), 55 * kDegree, 1e-12);
  EXPECT_NEAR(head_share(55 * kDegree), 27.5 * kDegree, 1e-12);
}

TEST(Gaze, EyesAndHeadReachATargetThatJumpsBy40Degrees) {
  const Clip clip = standing(3);
  for (const double side : {1.0, -1.0}) {
    const Vec3 before = target_at(-20 * side * kDegree), after = target_at(20 * side * kDegree);
    const auto made = gaze(clip, {{0.2, before}, {1.5, after}});
    const int last = clip.frame_count() - 1;
    for (const char* eye : {"left_eye", "right_eye"}) {
      EXPECT_LT(miss(made.clip, last, eye, after), 0.01 * kDegree);
      // 21 ms + 2.2 ms for each of 40 degrees after it begins.
      EXPECT_LT(miss(made.clip, static_cast<int>(1.63 * kRate), eye, after), 2 * kDegree);
    }
    EXPECT_NEAR(made.targets[1].amplitude, 40 * kDegree, 0.3 * kDegree);
    EXPECT_LT(made.targets[1].missed, 2 * kDegree);
  }
  // From straight ahead: 55 / 70 of what is beyond 20 degrees.
  const auto made = gaze(clip, {{0.5, target_at(40 * kDegree)}});
  EXPECT_NEAR(head_angle(made.clip, clip.frame_count() - 1), 20.0 * 55 / 70 * kDegree,
              0.1 * kDegree);
  EXPECT_NEAR(made.targets[0].head, 20.0 * 55 / 70 * kDegree, 0.1 * kDegree);
}

TEST(Gaze, EyesGoFirstAndComeBackAsTheHeadFollows) {
  const Clip clip = standing(3);
  const auto made = gaze(clip, {{0.5, target_at(60 * kDegree)}});
  const auto frame = [](double seconds) { return static_cast<int>(std::lround(seconds * kRate)); };
  EXPECT_EQ(head_angle(made.clip, frame(0.5)), 0);
  EXPECT_LT(head_angle(made.clip, frame(0.55)), 1e-6);
  EXPECT_GT(in_head(made.clip, frame(0.55), "left_eye").x(), 4);
  double most = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    most = std::max(most, in_head(made.clip, f, "left_eye").x());
  }
  EXPECT_NEAR(most, 44.2, 0.1);  // the range outwards, while the head is on its way
  EXPECT_NEAR(in_head(made.clip, clip.frame_count() - 1, "left_eye").x(), 60 - 40 * 55.0 / 70, 1.5);
}

TEST(Gaze, EyesKeepWithinTheirRanges) {
  const Clip clip = standing(2);
  std::vector<Character::Eye> eyes = kEyes;
  for (Character::Eye& eye : eyes) eye.range = {.in = 20, .out = 30, .up = 10, .down = 15};
  for (const double yaw : {-150.0, -60.0, 0.0, 35.0, 90.0}) {
    for (const double pitch : {-50.0, -20.0, 0.0, 30.0, 60.0}) {
      const auto made = gaze(clip, {{0.3, target_at(yaw * kDegree, pitch * kDegree)}}, eyes);
      for (int f = 0; f < clip.frame_count(); ++f) {
        const Vec2 left = in_head(made.clip, f, "left_eye");
        const Vec2 right = in_head(made.clip, f, "right_eye");
        EXPECT_TRUE(left.x() > -20.01 && left.x() < 30.01) << left.x();
        EXPECT_TRUE(right.x() > -30.01 && right.x() < 20.01) << right.x();
        EXPECT_TRUE(left.y() > -15.01 && left.y() < 10.01) << left.y();
      }
      const bool reachable = std::abs(yaw) < 70 && std::abs(pitch) < 45;
      if (reachable) {
        EXPECT_LT(made.targets[0].missed, 2 * kDegree) << yaw << ' ' << pitch;
      }
      EXPECT_EQ(made.targets[0].reached, made.targets[0].missed < 2 * kDegree);
    }
  }
}

TEST(Gaze, WhatItDoesNotTurnStaysBitForBit) {
  const Clip clip = standing(1);
  const auto made = gaze(clip, {{0.4, target_at(50 * kDegree)}, {0.7, {}}});
  ASSERT_EQ(made.clip.joint_count(), clip.joint_count() + 2);
  const std::vector<std::string> head = {"Neck", "Head", "Head_end"};
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      const bool turned = std::ranges::find(head, clip.skeleton.names[at(j)]) != head.end();
      if (turned && f > 0.4 * kRate) continue;
      EXPECT_EQ(clip.frame_positions(f)[at(j)], made.clip.frame_positions(f)[at(j)]);
    }
  }
  EXPECT_EQ(made.clip.skeleton.parents.back(), clip.skeleton.find("Head"));
}

TEST(Gaze, TurnsWithTheWorld) {
  const Clip clip = standing(1.5);
  Clip turned = clip;
  const Transform by{Vec3(3, 0, -2), from_rotation_vector(Vec3(0, 2, 0))};
  for (int f = 0; f < clip.frame_count(); ++f) {
    std::vector<Transform> pose(clip.skeleton.names.size());
    clip.get_pose(f, pose);
    for (Transform& joint : pose) joint = by * joint;
    turned.set_pose(f, pose);
  }
  const Vec3 point = target_at(45 * kDegree, 10 * kDegree);
  const auto a = gaze(clip, {{0.3, point}});
  const auto b = gaze(turned, {{0.3, by * point}});
  for (int f = 0; f < clip.frame_count(); f += 10) {
    const Quat there = by.orientation * orientation(a.clip, f, "left_eye");
    EXPECT_LT(angle_between(there, orientation(b.clip, f, "left_eye")), 1e-4) << f;
  }
}

TEST(Gaze, MistakesAreTold) {
  const Clip clip = standing(1);
  EXPECT_EQ(gaze_eyes({}, clip.skeleton, clip.skeleton).error().code, "gaze-eyes");
  const auto eyes = gaze_eyes(kEyes, clip.skeleton, clip.skeleton);
  ASSERT_TRUE(eyes.ok());
  const std::vector<GazeTarget> back = {{0.5, {}}, {0.5, {}}};
  EXPECT_EQ(apply_gaze(clip, *eyes, back, find_roles(clip.skeleton)).error().code, "gaze-time");
  EXPECT_EQ(apply_gaze(clip, {}, {}, find_roles(clip.skeleton)).error().code, "gaze-eyes");
}

}  // namespace
}  // namespace krok::ik
