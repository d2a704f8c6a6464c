// If these fail, limits are read as others than the file says, do not survive being written, or a
// mistake in a file is passed over or reported at the wrong place.

#include "formats/limits/limits_format.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "ik/limits.h"
#include "support/test_scenes.h"
#include "support/told_mistakes.h"

namespace krok::limits {
namespace {

constexpr const char* kGood = R"({
  "schema": "krok.limits/1",
  "joints": {
    "LeftForeArm": {"kind": "hinge", "axis": [0, 1, 0], "range": [-5, 145]},
    "LeftArm": {"kind": "cone", "axis": [1, 0, 0], "swing_axis": [0, 0, 1],
      "swing": [[-90, 60], [-30, 110]], "twist": [-80, 80], "zero": [0, 0.6, 0, 0.8]},
    "Head": {"kind": "locked", "comment": "stiff"},
    "Hips": {"kind": "free"}
  }
})";

TEST(LimitsFormat, ReadsWhatTheSpecSays) {
  const Skeleton skeleton = test::turned_human();
  const auto limits = read(kGood, skeleton);
  ASSERT_TRUE(limits.ok()) << limits.error().message;
  EXPECT_TRUE(ik::check(*limits, skeleton.joint_count()).ok());
  const auto of = [&](const char* name) { return (*limits)[at(skeleton.find(name))]; };
  EXPECT_EQ(of("LeftForeArm").kind, ik::JointLimit::Kind::hinge);
  EXPECT_EQ(of("LeftForeArm").axis, Vec3(0, 1, 0));
  EXPECT_NEAR(of("LeftForeArm").max_twist, 145 * kRadiansPerDegree, 1e-12);
  const Quat rest = skeleton.reference_local(skeleton.find("LeftForeArm")).orientation;
  EXPECT_NEAR(std::abs(of("LeftForeArm").zero.dot(rest)), 1, 1e-12);
  EXPECT_EQ(of("LeftArm").kind, ik::JointLimit::Kind::cone);
  EXPECT_NEAR(of("LeftArm").min_swing[0], -90 * kRadiansPerDegree, 1e-12);
  EXPECT_NEAR(of("LeftArm").max_swing[1], 110 * kRadiansPerDegree, 1e-12);
  EXPECT_NEAR(of("LeftArm").zero.y(), 0.6, 1e-12);
  EXPECT_EQ(of("Head").kind, ik::JointLimit::Kind::locked);
  EXPECT_EQ(of("Hips").kind, ik::JointLimit::Kind::free);
  EXPECT_EQ(of("RightArm").kind, ik::JointLimit::Kind::free);
  const auto radians =
      read(test::replaced(kGood, "\"joints\"", "\"angle_unit\": \"rad\", \"joints\""), skeleton);
  EXPECT_FALSE(radians.ok());  // 145 rad exceed two turns
}

TEST(LimitsFormat, WhatIsWrittenIsReadAgain) {
  const Skeleton skeleton = test::turned_human();
  const Clip clip = test::swinging_clip(skeleton, 50, 30);
  const Clip* one = &clip;
  for (const ik::Limits& limits : {ik::anatomical_limits(skeleton, find_roles(skeleton)),
                                   *ik::learn_limits(skeleton, {&one, 1})}) {
    const std::string text = write(limits, skeleton);
    const auto again = read(text, skeleton);
    ASSERT_TRUE(again.ok()) << again.error().message;
    for (std::size_t j = 0; j < limits.size(); ++j) {
      ASSERT_EQ((*again)[j].kind, limits[j].kind);
      if (limits[j].kind != ik::JointLimit::Kind::cone) continue;
      EXPECT_LT(((*again)[j].axis - limits[j].axis).norm(), 1e-12);
      EXPECT_LT(((*again)[j].zero.coeffs() - limits[j].zero.coeffs()).norm(), 1e-12);
      EXPECT_NEAR((*again)[j].max_twist, limits[j].max_twist, 1e-12);
      EXPECT_NEAR((*again)[j].min_swing[1], limits[j].min_swing[1], 1e-12);
    }
    EXPECT_EQ(write(*again, skeleton), text);
  }
}

TEST(LimitsFormat, MistakesAreToldWithTheirPlace) {
  const test::Mistake mistakes[] = {
      {"krok.limits/1", "krok.limits/9", "limits-structure 2:13"},
      {"\"LeftArm\"", "\"LeftArn\"", "limits-joint 5:5", "LeftArm"},
      {"\"hinge\"", "\"hing\"", "limits-value 4:29", "hinge"},
      {"\"range\"", "\"ranges\"", "limits-structure 4:57", "range"},
      {"[0, 1, 0]", "[0, 2, 0]", "limits-value 4:46", "length 2"},
      {"[0, 1, 0]", "[0, 1]", "limits-value 4:46", "3 numbers"},
      {"[0, 1, 0]", "[0, 1e999, 0]", "json-syntax 4:54"},
      {"[-5, 145]", "[145, -5]", "limits-value 4:66", "min"},
      {"[-5, 145]", "[-5, 1e9]", "limits-value 4:66", "exceeds"},
      {"[0, 0, 1]", "[1, 0, 0]", "limits-value 5:66", "perpendicular"},
      {"[[-90, 60], [-30, 110]]", "[[10, 60], [-30, 110]]", "limits-value 6:17", "contain 0"},
      {"[[-90, 60], [-30, 110]]", "[-90, 60]", "limits-value 6:16", "two ranges"},
      {"[[-90, 60], [-30, 110]]", "[[-90, 60], [-30, 190]]", "limits-value 6:28", "exceeds"},
      {"\"twist\": [-80, 80], ", "", "limits-structure 5:16", "twist"},
      {"[0, 0.6, 0, 0.8]", "[0, 0, 0, 0]", "limits-value 6:69", "length 0"},
      {"\"locked\"", "\"locked\", \"range\": [0, 1]", "limits-value 7:41", "does not use"},
      {"\"kind\": \"free\"", "", "limits-structure 8:13", "kind"}};
  const Skeleton skeleton = test::turned_human();
  test::expect_told(kGood, mistakes, [&](const std::string& text) { return read(text, skeleton); });
}

TEST(LimitsFormat, DamagedTextsNeverGiveLimitsThatMeanNothing) {
  const Skeleton skeleton = test::turned_human();
  std::mt19937 random(3);
  int read_well = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::string text = test::damaged(kGood, random);
    const auto limits = read(text, skeleton);
    if (limits.ok()) {
      ++read_well;
      EXPECT_TRUE(ik::check(*limits, skeleton.joint_count()).ok()) << text;
    } else {
      EXPECT_GT(limits.error().where.line, 0);
    }
  }
  EXPECT_GT(read_well, 50);
}

}  // namespace
}  // namespace krok::limits
