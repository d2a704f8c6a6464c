// If these fail, joints flip, jump or turn into NaN in some frames of some captures.
#include "math/quaternion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/special_values.h"
#include "unit/math/negated.h"

namespace krok {
namespace {

using test::kInfinity;
using test::kNan;
using test::negated;

Quat about(const Vec3& axis, double angle) {
  return from_rotation_vector(axis.normalized() * angle);
}

TEST(NormalizedOrIdentity, ScalesToUnitLength) {
  EXPECT_NEAR(normalized_or_identity(Quat(3, 0, 4, 0)).norm(), 1, 1e-15);
  EXPECT_NEAR(normalized_or_identity(Quat(3e200, 0, 4e200, 0)).y(), 0.8, 1e-15);
  EXPECT_NEAR(normalized_or_identity(Quat(3e-140, 0, 4e-140, 0)).y(), 0.8, 1e-15);
}

TEST(NormalizedOrIdentity, GivesTheIdentityForWhatHasNoDirection) {
  for (const Quat& q : {Quat(0, 0, 0, 0), Quat(1e-160, 0, 0, 0), Quat(kNan, 0, 0, 0),
                        Quat(1, kInfinity, 0, 0), Quat(0, 0, kNan, 1)}) {
    EXPECT_EQ(normalized_or_identity(q).coeffs(), Quat::Identity().coeffs());
  }
}

TEST(InHemisphereOf, FlipsOnlyTheOtherHalf) {
  const Quat q = about(Vec3(1, 2, 3), 0.5);
  EXPECT_EQ(in_hemisphere_of(Quat::Identity(), q).coeffs(), q.coeffs());
  EXPECT_EQ(in_hemisphere_of(Quat::Identity(), negated(q)).coeffs(), q.coeffs());
  const Quat half(0, 1, 0, 0);
  EXPECT_EQ(in_hemisphere_of(Quat::Identity(), half).coeffs(), half.coeffs());
}

TEST(AngleBetween, IsAccurateForTinyAndLargeAngles) {
  const Quat base = about(Vec3(1, -1, 2), 1.1);
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-4, 0.5, 2.0, kPi - 1e-8, kPi}) {
    const Quat turned = base * about(Vec3(0, 1, 1), angle);
    EXPECT_NEAR(angle_between(base, turned), angle, 1e-15 + 4e-16 * angle);
    EXPECT_NEAR(angle_between(base, negated(turned)), angle, 1e-15 + 4e-16 * angle);
  }
}

TEST(Slerp, AgreesWithTheClosedForm) {
  // A rotation about one axis: the angle goes linearly.
  const Vec3 axis = Vec3(0.3, -0.5, 0.8).normalized();
  const Quat a = about(axis, 0.2);
  for (const double arc : {1e-9, 1e-7, 9e-7, 1.1e-6, 1e-4, 0.1, 1.5, 3.0}) {
    const Quat b = about(axis, 0.2 + arc);
    for (const double t : {-0.5, 0.0, 0.25, 0.5, 0.9, 1.0, 1.5}) {
      const Quat expected = about(axis, 0.2 + t * arc);
      EXPECT_LT(angle_between(slerp(a, b, t), expected), 1e-14) << arc << " " << t;
      EXPECT_LT(angle_between(slerp(a, negated(b), t), expected), 1e-14) << arc << " " << t;
    }
  }
}

TEST(Slerp, EqualAndOppositeInputStay) {
  const Quat q = about(Vec3(1, 2, 3), 2.5);
  for (const double t : {0.0, 0.3, 1.0}) {
    EXPECT_LT(angle_between(slerp(q, q, t), q), 1e-15);
    EXPECT_LT(angle_between(slerp(q, negated(q), t), q), 1e-15);
    EXPECT_NEAR(slerp(q, negated(q), t).norm(), 1, 1e-15);
  }
}

TEST(Slerp, HalfATurnApartIsDefined) {
  const Quat a = Quat::Identity();
  const Quat b(0, 0, 1, 0);
  EXPECT_LT(angle_between(slerp(a, b, 0.5), about(Vec3::UnitY(), kPi / 2)), 1e-15);
  EXPECT_LT(angle_between(slerp(a, negated(b), 0.5), about(-Vec3::UnitY(), kPi / 2)), 1e-15);
}

TEST(Slerp, IsFiniteAndUnitForZeroInput) {
  const Quat zero(0, 0, 0, 0);
  const Quat q = about(Vec3(1, 0, 0), 1);
  for (const double t : {0.0, 0.5, 1.0}) {
    for (const Quat& result : {slerp(zero, zero, t), slerp(zero, q, t), slerp(q, zero, t)}) {
      EXPECT_NEAR(result.norm(), 1, 1e-15);
    }
  }
}

TEST(Nlerp, StaysOnTheShorterArc) {
  const Quat a = about(Vec3::UnitX(), 0.2);
  const Quat b = about(Vec3::UnitX(), 1.0);
  EXPECT_LT(angle_between(nlerp(a, b, 0.5), about(Vec3::UnitX(), 0.6)), 1e-15);
  EXPECT_LT(angle_between(nlerp(a, negated(b), 0.5), about(Vec3::UnitX(), 0.6)), 1e-15);
  EXPECT_EQ(nlerp(Quat(0, 0, 0, 0), Quat(0, 0, 0, 0), 0.5).coeffs(), Quat::Identity().coeffs());
}

TEST(RotationVector, GoesThereAndBack) {
  for (const double angle : {0.0, 1e-300, 1e-20, 1e-13, 1e-9, 1e-3, 1.0, kPi - 1e-9}) {
    const Vec3 v = Vec3(2, -1, 0.5).normalized() * angle;
    EXPECT_LE((rotation_vector(from_rotation_vector(v)) - v).norm(), 1e-15 + 4e-16 * angle)
        << angle;
  }
}

TEST(RotationVector, OfHalfATurnHasEitherSign) {
  const Vec3 v = Vec3(2, -1, 0.5).normalized() * kPi;
  const Vec3 back = rotation_vector(from_rotation_vector(v));
  EXPECT_LT(std::min((back - v).norm(), (back + v).norm()), 1e-14);
}

TEST(RotationVector, TakesTheShortWay) {
  EXPECT_NEAR(rotation_vector(about(Vec3::UnitZ(), 1.5 * kPi)).z(), -kPi / 2, 1e-15);
  EXPECT_LE(rotation_vector(from_rotation_vector(Vec3(100, 7, -3))).norm(), kPi);
  const Quat q = about(Vec3(1, 1, 0), 0.7);
  EXPECT_TRUE(rotation_vector(q).isApprox(rotation_vector(negated(q)), 1e-15));
  EXPECT_EQ(rotation_vector(Quat::Identity()), Vec3::Zero());
  EXPECT_EQ(rotation_vector(negated(Quat::Identity())), Vec3::Zero());
}

TEST(RotationVector, ZeroAndBadInputGiveNoRotation) {
  EXPECT_EQ(rotation_vector(Quat(0, 0, 0, 0)), Vec3::Zero());
  EXPECT_EQ(from_rotation_vector(Vec3(kNan, 0, 0)).coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(from_rotation_vector(Vec3(kInfinity, 0, 0)).coeffs(), Quat::Identity().coeffs());
}

TEST(ShortestArc, TakesOneDirectionToTheOther) {
  const Vec3 from(1, 2, -3);
  for (const Vec3& to : {Vec3(4, 0, 1), Vec3(-1, 5, 2), Vec3(1, 2, -3.0000001), Vec3(2, 4, -6),
                         Vec3(-1, -2, 3.0000001)}) {
    const Quat q = shortest_arc(from, to);
    EXPECT_LT((q * from.normalized() - to.normalized()).norm(), 1e-14);
    // No turn beyond the angle between the directions.
    const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
    EXPECT_NEAR(angle_between(Quat::Identity(), q), angle, 1e-14);
  }
}

TEST(ShortestArc, OppositeDirectionsAreHalfATurn) {
  for (const Vec3& from :
       {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 1), Vec3(-3, 2, 5)}) {
    const Quat q = shortest_arc(from, -from);
    EXPECT_LT((q * from.normalized() + from.normalized()).norm(), 1e-14);
    EXPECT_NEAR(q.norm(), 1, 1e-15);
    EXPECT_NEAR(q.vec().dot(from.normalized()), 0, 1e-15);
    EXPECT_EQ(q.coeffs(), shortest_arc(from, -2 * from).coeffs());
  }
}

TEST(ShortestArc, ZeroAndExtremeInput) {
  EXPECT_EQ(shortest_arc(Vec3::Zero(), Vec3(1, 0, 0)).coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(shortest_arc(Vec3(1, 0, 0), Vec3::Zero()).coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(shortest_arc(Vec3(kNan, 0, 0), Vec3(1, 0, 0)).coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(shortest_arc(Vec3(2, 3, 4), Vec3(4, 6, 8)).coeffs(), Quat::Identity().coeffs());
  const Quat q = shortest_arc(Vec3(1e-200, 0, 0), Vec3(0, 1e200, 0));
  EXPECT_LT((q * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-14);
}

}  // namespace
}  // namespace krok
