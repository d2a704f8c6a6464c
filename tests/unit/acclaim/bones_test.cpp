// If these fail, a joint turns about the wrong axis, in the wrong order or in the wrong place, or
// the figure has a wrong size.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "math/quaternion.h"
#include "unit/acclaim/reading.h"
#include "unit/acclaim/small_files.h"

namespace krok::acclaim::test {
namespace {

using small_files::kAmc;
using small_files::kAsf;
using small_files::with;

TEST(AcclaimReader, joints_stand_at_the_beginnings_of_bones_and_leaves_have_ends) {
  const auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const krok::Skeleton& skeleton = capture->clip.skeleton;
  EXPECT_THAT(skeleton.names,
              testing::ElementsAre("root", "thigh", "shin", "shin_end", "tail", "tip", "tip_end"));
  EXPECT_THAT(skeleton.parents, testing::ElementsAre(-1, 0, 1, 2, 0, 4, 5));
  EXPECT_THAT(skeleton.end_sites, testing::ElementsAre(0, 0, 0, 1, 0, 0, 1));
  expect_near(skeleton.reference[3].position, {0, -9, 0});
  expect_near(skeleton.reference[6].position, {0, 0, -3});
  for (const auto& joint : skeleton.reference) {
    EXPECT_TRUE(joint.orientation.coeffs() == krok::Quat::Identity().coeffs());
  }
  EXPECT_EQ(capture->name, "two bones");
  EXPECT_EQ(capture->documentation, "made by hand\nfor tests");
}

TEST(AcclaimReader, bones_turn_about_their_own_axes_in_the_order_of_dof) {
  const auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok());
  ASSERT_EQ(capture->clip.frame_count(), 3);
  expect_near(position(*capture, 0, "shin_end"), {0, 0, 0});
  // Frame 2: the root looks to +X. The thigh, turned by 90 degrees about x, points to the root's
  // -z, the world's -x. The shin's x is the root's -z (90 degrees about y), along which the thigh
  // points after its turn has taken (0,0,-1) to (0,1,0): it turns about the thigh's (0,0,-1).
  expect_near(position(*capture, 1, "shin"), {1 - 4, 9, 0});
  // In the thigh's frame the shin's (0,-1,0) turns about (0,0,-1) by 90 degrees to (-1,0,0); the
  // thigh's turn about x leaves that, the root's about y takes it to (0,0,1).
  expect_near(position(*capture, 1, "shin_end"), {1 - 4, 9, 5});
  // Frame 3: rz first, then rx. (0,-1,0) turns about z to (1,0,0), which rx leaves alone; in the
  // other order it would end at (0,0,-1).
  expect_near(position(*capture, 2, "shin"), {1 + 4, 9, 0});
}

TEST(AcclaimReader, translation_moves_along_the_bones_axes_and_l_is_its_length) {
  const auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok());
  // The tail's x is the root's y (90 degrees about z); its bone points to -z, in frame 2 to -x.
  expect_near(position(*capture, 1, "tail"), {1, 9.5, 0});
  expect_near(position(*capture, 1, "tip"), {1 - 3, 9.5, 0});
  expect_near(position(*capture, 1, "tip_end"), {1 - 4, 9.5, 0});
  // A bone that the motion does not mention keeps the length of the skeleton.
  const auto without = read(kAsf, with(kAmc, "tail 0 2\n", ""));
  ASSERT_TRUE(without.ok());
  expect_near(position(*without, 0, "tip"), {0, 9, -2});
  EXPECT_TRUE(told(*without, "acclaim-missing", "tail")) << all(*without);
}

TEST(AcclaimReader, axis_order_turns_about_the_first_letter_first) {
  // C = Rz(90) Rx(90) for XYZ takes x to y; C = Rx(90) Rz(90) for ZYX takes x to z.
  const std::string asf = with(kAsf, "axis 0 90 0 XYZ", "axis 90 0 90 {}");
  for (const auto& [order, end] :
       {std::pair("XYZ", Vec3(0, 0, 0)), std::pair("zyx", Vec3(5, 5, 0))}) {
    const std::string text = with(asf, "{}", order);
    const auto capture = read(text, ":FULLY-SPECIFIED\n1\nroot 0 9 0 0 0 0\nthigh 0 0\nshin 90\n");
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    expect_near(position(*capture, 0, "shin_end"), end);
  }
}

TEST(AcclaimReader, root_order_says_where_values_stand_and_which_turn_is_first) {
  // ry after rx: (0,-1,0) turns about x to (0,0,-1), then about y to (-1,0,0).
  const std::string asf = with(kAsf, "order TX TY TZ RX RY RZ", "order rx tz ty tx ry rz");
  const auto capture = read(asf, ":FULLY-SPECIFIED\n1\nroot 90 3 2 1 90 0\nthigh 0 0\n");
  ASSERT_TRUE(capture.ok());
  expect_near(position(*capture, 0, "root"), {1, 2, 3});
  expect_near(position(*capture, 0, "shin"), {1 - 4, 2, 3});
  const auto reversed = read(with(kAsf, "order TX TY TZ RX RY RZ", "order tx ty tz ry rx rz"),
                             ":FULLY-SPECIFIED\n1\nroot 1 2 3 90 90 0\nthigh 0 0\n");
  ASSERT_TRUE(reversed.ok());
  expect_near(position(*reversed, 0, "shin"), {1, 2, 3 - 4});
}

TEST(AcclaimReader, the_roots_own_place_comes_before_the_motion) {
  std::string asf = with(kAsf, "position 0 0 0", "position 0 0 7");
  asf = with(asf, "orientation 0 0 0", "orientation 0 90 0");
  const auto capture = read(asf, kAmc);
  ASSERT_TRUE(capture.ok());
  expect_near(capture->clip.skeleton.reference[5].position, {-2, 0, 7});  // (0,0,-2) turned
  // Frame 2 has the root at x = 1, turned about y by another 90 degrees.
  expect_near(position(*capture, 1, "root"), {0, 9, 7 - 1});
  expect_near(position(*capture, 1, "shin"), {0, 9, 6 + 4});
  EXPECT_TRUE(told(*capture, "acclaim-root", "position or orientation")) << all(*capture);
}

TEST(AcclaimReader, radians_of_skeleton_and_motion_are_told_apart) {
  const std::string asf =
      with(with(kAsf, "angle deg", "angle rad"), "axis 0 90 0", "axis 0 1.5707963267948966 0");
  const std::string in_asf = with(asf, "axis 0 0 90", "axis 0 0 1.5707963267948966");
  const auto degrees = read(in_asf, kAmc);
  const auto reference = read(kAsf, kAmc);
  ASSERT_TRUE(degrees.ok() && reference.ok());
  expect_near(position(*degrees, 1, "shin_end"), position(*reference, 1, "shin_end"));
  // Without a word in the motion the skeleton's unit holds.
  const std::string radians =
      ":FULLY-SPECIFIED\n1\nroot 1 9 0 0 1.5707963267948966 0\nthigh 0 1.5707963267948966\n"
      "shin 1.5707963267948966\ntail 0.5 3\n";
  for (const std::string& amc : {radians, with(radians, "SPECIFIED\n", "SPECIFIED\n:RADIANS\n")}) {
    const auto capture = read(in_asf, amc);
    ASSERT_TRUE(capture.ok());
    expect_near(position(*capture, 0, "shin_end"), position(*reference, 1, "shin_end"));
  }
}

TEST(AcclaimReader, limits_are_read_with_their_axes) {
  ReadOptions options = plain();
  options.unit = krok::Unit{0.5, "half metres"};
  const auto capture = read(kAsf, kAmc, options);
  ASSERT_TRUE(capture.ok());
  ASSERT_EQ(capture->freedoms.size(), 7u);
  const auto& thigh = capture->freedoms[1].degrees;
  ASSERT_EQ(thigh.size(), 2u);
  EXPECT_EQ(thigh[0].axis, 2);
  EXPECT_EQ(thigh[0].lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(thigh[1].axis, 0);
  EXPECT_NEAR(thigh[1].lower, -krok::kPi / 2, 1e-12);
  EXPECT_NEAR(thigh[1].upper, krok::kPi / 4, 1e-12);
  const auto& tail = capture->freedoms[4].degrees;
  ASSERT_EQ(tail.size(), 2u);
  EXPECT_EQ(tail[0].kind, DegreeOfFreedom::Kind::translation);
  EXPECT_DOUBLE_EQ(tail[0].lower, -0.5);
  EXPECT_EQ(tail[1].kind, DegreeOfFreedom::Kind::stretch);
  EXPECT_DOUBLE_EQ(tail[1].lower, 1.0);
  EXPECT_LT(krok::angle_between(capture->freedoms[2].axes,
                                krok::axis_rotation(krok::Axis::y, krok::kPi / 2)),
            1e-9);
  EXPECT_TRUE(capture->freedoms[3].degrees.empty());
}

TEST(AcclaimReader, given_axes_turn_reference_and_motion_alike) {
  ReadOptions options = plain();
  options.up = krok::Direction::plus_z;
  options.forward = krok::Direction::minus_y;
  const auto turned = read(kAsf, kAmc, options);
  const auto as_is = read(kAsf, kAmc);
  ASSERT_TRUE(turned.ok() && as_is.ok());
  for (int f = 0; f < 3; ++f) {
    for (const char* joint : {"root", "shin_end", "tip_end"}) {
      const Vec3 p = position(*as_is, f, joint);
      expect_near(position(*turned, f, joint), {p.x(), p.z(), -p.y()});
    }
  }
  EXPECT_TRUE(turned->clip.skeleton.reference[2].orientation.isApprox(krok::Quat::Identity()));
}

TEST(AcclaimReader, a_unit_that_makes_a_person_is_believed_and_another_is_not) {
  // Two legs make no figure that could be recognised, so only :units speaks.
  ReadOptions options;
  const auto cmu = read(with(kAsf, "length 1.0", "length 0.45"), kAmc, options);
  ASSERT_TRUE(cmu.ok());
  EXPECT_EQ(cmu->conventions.unit.name, "cmu");
  EXPECT_NEAR(cmu->clip.skeleton.reference[3].position.y(), -9 * 0.0254 / 0.45, 1e-9);
  const auto other = read(with(kAsf, "length 1.0", "length 0.15"), kAmc, options);
  ASSERT_TRUE(other.ok());
  EXPECT_NEAR(other->conventions.unit.metres, 0.0254 / 0.15, 1e-12);
  const auto none = read(with(kAsf, "length 1.0", "length 1e-9"), kAmc, options);
  ASSERT_TRUE(none.ok());
  EXPECT_LT(none->conventions.unit.metres, 2.0);
}

}  // namespace
}  // namespace krok::acclaim::test
