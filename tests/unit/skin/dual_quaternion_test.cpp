// Would fail if a matrix and the two phases that it is split into were not the same map, or if the
// joint did not stay in its place in the first.

#include "skin/palette.h"

#include <limits>

#include "skinned.h"

namespace krok::test {
namespace {

Vec3 moved(const DualQuaternion& motion, const Vec3& point) {
  const float* c = motion.components;
  const Quat real(c[3], c[0], c[1], c[2]), dual(c[7], c[4], c[5], c[6]);
  return real * point + 2 * (dual * real.conjugate()).vec();
}
Vec3 moved(const SkinMatrix& matrix, const Vec3& point) {
  const Mat4 m = Eigen::Map<const Mat4f>(matrix.elements).cast<double>();
  return (m * point.homogeneous()).head<3>();
}

void expect_same_map(const SkinMatrix& matrix, const Vec3& centre) {
  const SplitMatrix parts = split(matrix, centre);
  Random random(1);
  for (int i = 0; i < 10; ++i) {
    const Vec3 point = random.vector();
    EXPECT_LT((moved(parts.motion, moved(parts.deformation, point)) - moved(matrix, point)).norm(),
              3e-6);
  }
  EXPECT_LT((moved(parts.deformation, centre) - centre).norm(), 1e-6);
  double length = 0, product = 0;
  for (int i = 0; i < 4; ++i) {
    const double real = parts.motion.components[i];
    length += real * real;
    product += real * parts.motion.components[4 + i];
  }
  EXPECT_NEAR(length, 1, 1e-6);
  EXPECT_NEAR(product, 0, 1e-6);
}

TEST(DualQuaternion, MovesAsTheTransformDoes) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Transform transform = random.transform();
    const Vec3 point = random.vector();
    EXPECT_LT((moved(dual_quaternion(transform), point) - transform * point).norm(), 1e-6);
  }
}

TEST(DualQuaternion, SplitMatricesAreTheSameMap) {
  Random random(3);
  for (const SkinMatrix& matrix : random_palette(60, 4, true)) {
    expect_same_map(matrix, random.vector());
  }
}

TEST(DualQuaternion, MatricesWithoutAnInverseSplitToo) {
  Mat4 flat = Transform{Vec3(1, 2, 3), from_rotation_vector(Vec3(1, 2, 0.5))}.matrix();
  flat.col(2).setZero();
  expect_same_map(skin_matrix(flat), Vec3(1, 0, 2));
  flat.col(1).setZero();
  expect_same_map(skin_matrix(flat), Vec3(1, 0, 2));
  flat.col(0).setZero();
  expect_same_map(skin_matrix(flat), Vec3(1, 0, 2));
}

TEST(DualQuaternion, RigidMatricesDeformNothing) {
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const SkinMatrix matrix = skin_matrix(random.transform().matrix());
    EXPECT_TRUE(is_rigid(matrix));
    const SplitMatrix parts = split(matrix, random.vector());
    EXPECT_EQ(Eigen::Map<const Mat4f>(parts.deformation.elements), Mat4f::Identity());
  }
}

TEST(DualQuaternion, SaysWhatIsNotRigid) {
  Mat4 matrix = Mat4::Identity();
  matrix(1, 1) = 1.0001;
  EXPECT_FALSE(is_rigid(skin_matrix(matrix)));
  matrix(1, 1) = -1;
  EXPECT_FALSE(is_rigid(skin_matrix(matrix)));
  matrix(1, 1) = 1;
  matrix(0, 1) = 0.001;
  EXPECT_FALSE(is_rigid(skin_matrix(matrix)));
  matrix(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_rigid(skin_matrix(matrix)));
}

TEST(DualQuaternion, WhatIsNotFiniteDoesNotTurn) {
  for (const double odd :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Mat4 matrix = Mat4::Identity();
    matrix(2, 0) = odd;
    const SplitMatrix parts = split(skin_matrix(matrix), Vec3(1, 2, 3));
    for (int i = 0; i < 4; ++i) EXPECT_EQ(parts.motion.components[i], i == 3 ? 1.0f : 0.0f);
    EXPECT_FALSE(Eigen::Map<const Mat4f>(parts.deformation.elements).allFinite());
  }
}

}  // namespace
}  // namespace krok::test
