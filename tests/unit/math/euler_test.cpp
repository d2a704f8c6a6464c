// If these fail, BVH files in some channel order are read or written with wrong rotations.
#include "math/quaternion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/transform.h"

namespace krok {
namespace {

constexpr EulerOrder kOrders[] = {{Axis::x, Axis::y, Axis::z}, {Axis::x, Axis::z, Axis::y},
                                  {Axis::y, Axis::x, Axis::z}, {Axis::y, Axis::z, Axis::x},
                                  {Axis::z, Axis::x, Axis::y}, {Axis::z, Axis::y, Axis::x}};

Mat3 by_eigen(const EulerOrder& order, const Vec3& angles) {
  Mat3 m = Mat3::Identity();
  for (int i = 0; i < 3; ++i) {
    m = m * Eigen::AngleAxisd(angles[i],
                              Vec3::Unit(static_cast<int>(order[static_cast<std::size_t>(i)])))
                .toRotationMatrix();
  }
  return m;
}

Quat compose(const EulerOrder& order, const Vec3& angles) {
  return from_axis_rotations(order, std::span(angles.data(), 3));
}

TEST(AxisRotation, IsRightHandedAndExactForZero) {
  EXPECT_EQ(axis_rotation(Axis::y, 0).coeffs(), Quat::Identity().coeffs());
  EXPECT_LT((axis_rotation(Axis::z, kPi / 2) * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_LT((axis_rotation(Axis::x, kPi / 2) * Vec3::UnitY() - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_LT((axis_rotation(Axis::y, kPi / 2) * Vec3::UnitZ() - Vec3::UnitX()).norm(), 1e-15);
}

TEST(FromAxisRotations, AgreesWithEigenInAllOrders) {
  for (const EulerOrder& order : kOrders) {
    for (const Vec3& angles : {Vec3(0.3, -1.2, 2.5), Vec3(-3, 1.5, 0.1), Vec3(7, -20, 300)}) {
      EXPECT_TRUE(
          compose(order, angles).toRotationMatrix().isApprox(by_eigen(order, angles), 1e-12));
    }
  }
}

TEST(FromAxisRotations, TakesAnyNumberOfAxes) {
  EXPECT_EQ(from_axis_rotations({}, {}).coeffs(), Quat::Identity().coeffs());
  const Axis twice[] = {Axis::x, Axis::x};
  const double angles[] = {0.25, 0.5};
  EXPECT_LT(angle_between(from_axis_rotations(twice, angles), axis_rotation(Axis::x, 0.75)), 1e-15);
}

TEST(ToEuler, ComposesBackInAllOrdersAndRanges) {
  for (const EulerOrder& order : kOrders) {
    for (int a = -9; a <= 9; ++a) {
      for (int b = -8; b <= 8; ++b) {
        for (int c = -9; c <= 9; ++c) {
          const Vec3 angles(a * kPi / 9, b * kPi / 16, c * kPi / 9);
          const Quat q = compose(order, angles);
          const Vec3 found = to_euler(q, order);
          EXPECT_LT(angle_between(compose(order, found), q), 1e-7);
          EXPECT_LE(std::abs(found[1]), kPi / 2);
          EXPECT_GE(found[0], -kPi);
          EXPECT_LE(found[0], kPi);
          EXPECT_GE(found[2], -kPi);
          EXPECT_LE(found[2], kPi);
        }
      }
    }
  }
}

TEST(ToEuler, ReadsAnglesBackAwayFromTheLock) {
  for (const EulerOrder& order : kOrders) {
    const Vec3 angles(0.7, -1.3, 2.1);
    EXPECT_LT((to_euler(compose(order, angles), order) - angles).norm(), 1e-13);
  }
}

TEST(ToEuler, AtTheLockTheLastAngleIsTheOneGiven) {
  for (const EulerOrder& order : kOrders) {
    for (const double middle : {kPi / 2, -kPi / 2}) {
      for (const double last : {0.0, 0.4, -2.0}) {
        const Quat q = compose(order, Vec3(0.9, middle, 0.2));
        const Vec3 found = to_euler(q, order, last);
        EXPECT_EQ(found[2], last);
        EXPECT_NEAR(found[1], middle, 1e-7);
        EXPECT_LT(angle_between(compose(order, found), q), 1e-7);
      }
    }
  }
}

TEST(ToEuler, NearTheLockItStaysAccurate) {
  for (const EulerOrder& order : kOrders) {
    for (const double off : {1e-3, 1e-5, 1e-6, 2e-7, 1e-7, 5e-8, 1e-9}) {
      const Quat q = compose(order, Vec3(0.9, kPi / 2 - off, 0.2));
      EXPECT_LT(angle_between(compose(order, to_euler(q, order)), q), 3e-7) << off;
    }
  }
}

TEST(ClosestEuler, UnwrapsTurns) {
  const Vec3 previous(6.2, 0.1, -3.1);
  const Vec3 found = closest_euler(Vec3(6.2 - 2 * kPi + 0.01, 0.1, 3.1), previous);
  EXPECT_LT((found - Vec3(6.21, 0.1, 3.1 - 2 * kPi)).norm(), 1e-12);
}

TEST(ClosestEuler, TakesTheOtherBranchWhereItIsCloser) {
  // A curve that runs through the lock: the middle angle goes on beyond a quarter turn.
  for (const EulerOrder& order : kOrders) {
    Vec3 previous(0.3, 0, -0.2);
    for (int i = 0; i <= 100; ++i) {
      const Vec3 angles(0.3, i * 0.02 + 0.005, -0.2);
      const Quat q = compose(order, angles);
      previous = closest_euler(to_euler(q, order, previous[2]), previous);
      EXPECT_LT((previous - angles).norm(), 1e-6) << i;
    }
  }
}

TEST(Transform, ComposesAndInverts) {
  const Transform a{Vec3(1, 2, 3), from_rotation_vector(Vec3(0.1, 0.9, -0.4))};
  const Transform b{Vec3(-4, 0, 2), from_rotation_vector(Vec3(2, 0.3, 0))};
  const Vec3 p(0.5, -7, 2);
  EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-13);
  EXPECT_LT((a.inverse() * (a * p) - p).norm(), 1e-13);
  EXPECT_LT(((a * b).matrix() - a.matrix() * b.matrix()).norm(), 1e-13);
  EXPECT_EQ(Transform().matrix(), Mat4::Identity());
}

}  // namespace
}  // namespace krok
