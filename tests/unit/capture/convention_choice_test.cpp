// If these fail, what the user says of a file is not followed, a figure comes in turned, mirrored
// or in a wrong size, or a mesh that was bound in the reference pose does not follow the motion.

#include "capture/convention_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace krok {
namespace {

using testing::HasSubstr;

constexpr std::array kDirections = {Direction::plus_x,  Direction::minus_x, Direction::plus_y,
                                    Direction::minus_y, Direction::plus_z,  Direction::minus_z};

bool along_one_axis(Direction a, Direction b) {
  return direction_vector(a).cross(direction_vector(b)).isZero(0);
}

Conventions conventions_of(Direction up, Direction forward) {
  Conventions conventions;
  conventions.up = conventions.reference_up = up;
  conventions.forward = conventions.reference_forward = forward;
  return conventions;
}

TEST(ApplyGiven, ReplacesWhatWasDetected) {
  Conventions conventions = conventions_of(Direction::plus_z, Direction::minus_y);
  conventions.reference_up = Direction::plus_y;
  conventions.reference_forward = Direction::plus_z;
  GivenConventions given;
  given.unit = Unit{0.01, "cm"};
  given.up = Direction::plus_x;
  given.forward = Direction::minus_z;
  EXPECT_TRUE(given.complete());
  apply_given(given, conventions);
  EXPECT_EQ(conventions.unit.metres, 0.01);
  EXPECT_EQ(conventions.up, Direction::plus_x);
  EXPECT_EQ(conventions.reference_up, Direction::plus_x);
  EXPECT_EQ(conventions.forward, Direction::minus_z);
  EXPECT_EQ(conventions.reference_forward, Direction::minus_z);
  EXPECT_EQ(conventions.up_confidence, Confidence::certain);
}

// Would fail if an axis that lays a clearly standing figure down were taken without a word.
TEST(ApplyGiven, AnUpAxisAgainstWhatIsSeenIsDoubted) {
  for (const Confidence seen : {Confidence::guess, Confidence::likely}) {
    Conventions conventions = conventions_of(Direction::plus_y, Direction::plus_z);
    conventions.up_confidence = seen;
    conventions.up_reason = "it stands";
    GivenConventions given;
    given.up = Direction::plus_z;
    apply_given(given, conventions);
    EXPECT_EQ(conventions.up, Direction::plus_z);
    Diagnostics diagnostics;
    report_conventions(conventions, given, "bvh", "a.bvh", diagnostics);
    const bool doubted = std::ranges::any_of(diagnostics, [](const Diagnostic& diagnostic) {
      return diagnostic.severity == Severity::warning &&
             diagnostic.message == "up is z, as given; y is likely: it stands";
    });
    EXPECT_EQ(doubted, seen == Confidence::likely);
  }
}

TEST(ApplyGiven, NothingGivenChangesNothing) {
  Conventions conventions = conventions_of(Direction::plus_z, Direction::minus_y);
  conventions.up_reason = "seen";
  apply_given({}, conventions);
  EXPECT_EQ(conventions.up, Direction::plus_z);
  EXPECT_EQ(conventions.forward, Direction::minus_y);
  EXPECT_EQ(conventions.up_reason, "seen");
}

TEST(ApplyGiven, ADetectedAxisGivesWayToAGivenOne) {
  for (const Direction up : kDirections) {
    for (const Direction forward : kDirections) {
      if (along_one_axis(up, forward)) continue;
      for (const Direction given : kDirections) {
        Conventions turned = conventions_of(up, forward);
        GivenConventions only_up;
        only_up.up = given;
        apply_given(only_up, turned);
        EXPECT_EQ(turned.up, given);
        EXPECT_FALSE(along_one_axis(turned.up, turned.forward));
        EXPECT_FALSE(along_one_axis(turned.reference_up, turned.reference_forward));
        EXPECT_EQ(turned.forward == forward, !along_one_axis(given, forward));

        turned = conventions_of(up, forward);
        GivenConventions only_forward;
        only_forward.forward = given;
        apply_given(only_forward, turned);
        EXPECT_EQ(turned.forward, given);
        EXPECT_FALSE(along_one_axis(turned.up, turned.forward));
        EXPECT_EQ(turned.up == up, !along_one_axis(given, up));
      }
    }
  }
}

TEST(Conversion, KroksOwnConventionsChangeNothing) {
  const auto conversion = Conversion::make(Conventions());
  ASSERT_TRUE(conversion.ok());
  const Transform any{{1.1, -2.2, 3.3}, Quat(0.5, 0.5, -0.5, 0.5)};
  for (const Transform& same : {conversion->pose(any), conversion->reference(any)}) {
    EXPECT_EQ(same.position, any.position);
    EXPECT_EQ(same.orientation.coeffs(), any.orientation.coeffs());
  }
  EXPECT_EQ(conversion->reference_to_motion().orientation.coeffs(), Quat::Identity().coeffs());
}

TEST(Conversion, AxesAndUnitAreBrought) {
  for (const Direction up : kDirections) {
    for (const Direction forward : kDirections) {
      Conventions conventions = conventions_of(up, forward);
      conventions.unit = {0.01, "cm"};
      const auto conversion = Conversion::make(conventions);
      ASSERT_EQ(conversion.ok(), !along_one_axis(up, forward));
      if (!conversion.ok()) continue;
      const Vec3 high = 200 * direction_vector(up) + 300 * direction_vector(forward);
      EXPECT_EQ(conversion->pose({high, Quat::Identity()}).position, Vec3(0, 2, 3));
      EXPECT_EQ(conversion->reference({high, Quat::Identity()}).position, Vec3(0, 2, 3));
      // A quarter turn about the file's up is one about Krok's.
      const Quat turn(Eigen::AngleAxisd(0.5, direction_vector(up)));
      const Quat about_y(Eigen::AngleAxisd(0.5, Vec3::UnitY()));
      EXPECT_LT(conversion->pose({high, turn}).orientation.angularDistance(about_y), 1e-12);
    }
  }
}

TEST(Conversion, WhatIsBoundInTheReferencePoseFollowsWhereItsAxesDiffer) {
  // Stored y-up, facing +z; the motion's world is z-up and the figure faces -y.
  Conventions conventions = conventions_of(Direction::plus_z, Direction::minus_y);
  conventions.reference_up = Direction::plus_y;
  conventions.reference_forward = Direction::plus_z;
  conventions.unit = {0.1, "dm"};
  const auto conversion = Conversion::make(conventions);
  ASSERT_TRUE(conversion.ok());
  const Transform in_file{{1, 2, 3}, Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()))};
  const Vec3 point(4, 5, 6);  // of a mesh, in the reference pose, where the joint's frame is I
  const Vec3 moved = conversion->pose({in_file * point, Quat::Identity()}).position;
  const Vec3 bound = conversion->reference({point, Quat::Identity()}).position;
  EXPECT_LT((conversion->pose(in_file) * bound - moved).norm(), 1e-12);
  // The way over the reference pose's axes and then to the motion's is the same.
  const Quat in_reference = conversion->reference_rotation(in_file.orientation);
  EXPECT_LT((conversion->reference_to_motion().orientation * in_reference)
                .angularDistance(conversion->pose(in_file).orientation),
            1e-12);
}

TEST(ReportConventions, TellsWhatWasNotGiven) {
  Conventions conventions = conventions_of(Direction::plus_z, Direction::minus_y);
  conventions.up_confidence = Confidence::certain;
  conventions.forward_confidence = Confidence::guess;
  GivenConventions given;
  given.unit = Unit{0.01, "cm"};
  Diagnostics told;
  report_conventions(conventions, given, "bvh", "a.bvh", told);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].code, "bvh-up");
  EXPECT_EQ(told[0].severity, Severity::note);
  EXPECT_EQ(told[0].where.file, "a.bvh");
  EXPECT_EQ(told[1].code, "bvh-forward");
  EXPECT_EQ(told[1].severity, Severity::warning);
  EXPECT_THAT(told[1].hint, HasSubstr("--forward"));
}

TEST(DescribeConversions, OneLineForEachChange) {
  EXPECT_TRUE(describe_conversions(Conventions(), {}).empty());
  Conventions conventions = conventions_of(Direction::plus_z, Direction::minus_y);
  conventions.unit = {0.01, "cm"};
  EXPECT_EQ(describe_conversions(conventions, {}).size(), 2u);
  conventions.reference_up = Direction::plus_x;
  const auto lines = describe_conversions(conventions, {});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_THAT(lines[0], HasSubstr("cm (0.01 m) to metres"));
  EXPECT_THAT(lines[1], HasSubstr("up z"));
  EXPECT_THAT(lines[2], HasSubstr("reference pose: up x"));
}

}  // namespace
}  // namespace krok
