// Would fail if rotations found step by step were others than by singular values: joints of arrays
// of positions would turn.

#include <gtest/gtest.h>

#include <cmath>

#include "math/dense_solve.h"
#include "math/quaternion.h"
#include "samples/generator/noise.h"

namespace krok {
namespace {

double off(const Mat3& a, const Quat& near) {
  return angle_between(Quat(nearest_rotation(a)), nearest_rotation(a, near));
}

TEST(NearestRotation, StepsLeadToThatOfTheSingularValues) {
  samples::NoiseSource noise(3);
  for (int i = 0; i < 2000; ++i) {
    Mat3 a;
    for (double& value : a.reshaped()) value = noise.gaussian();
    const Vec3 away(noise.gaussian(), noise.gaussian(), noise.gaussian());
    const Quat near = Quat(nearest_rotation(a)) * from_rotation_vector(i % 3 * 0.3 * away);
    EXPECT_LT(off(a, near.normalized()), 1e-6) << a;
  }
}

TEST(NearestRotation, OfTwoBonesAReflectionOrNothingIsThatOfTheSingularValues) {
  const Quat turned = from_rotation_vector(Vec3(0.4, -1, 0.2));
  const Mat3 plane = turned * Vec3(1, 2, 0.5).asDiagonal() * Mat3::Identity();
  Mat3 flat = plane, mirrored = plane;
  flat.col(2).setZero();
  mirrored.col(2) *= -1;
  for (const Mat3& a : {flat, mirrored}) {
    EXPECT_LT(off(a, Quat::Identity()), 1e-6) << a;
    EXPECT_LT(off(a, turned), 1e-6) << a;
  }
  EXPECT_NEAR(nearest_rotation(Mat3(Mat3::Zero()), Quat::Identity()).norm(), 1, 1e-12);
}

}  // namespace
}  // namespace krok
