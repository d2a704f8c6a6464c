// If these fail, rotations between keys jump in angular velocity or miss their keys.
#include "math/quaternion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "unit/math/negated.h"

namespace krok {
namespace {

using test::negated;

struct Keys {
  std::vector<double> times;
  std::vector<Quat> rotations;
  std::vector<Vec3> velocities;

  Quat at(double time) const {
    std::size_t k = key_before(times, time);
    if (k + 1 == times.size()) --k;
    const double span = times[k + 1] - times[k];
    return squad(rotations[k], velocities[k], rotations[k + 1], velocities[k + 1], span,
                 (time - times[k]) / span);
  }
  // Radians a second in the moving frame, by differences.
  Vec3 angular_velocity(double time, double step) const {
    return rotation_vector(at(time).conjugate() * at(time + step)) / step;
  }
};

Keys keys(std::vector<double> times, std::vector<Quat> rotations, double tension = 0,
          Ends ends = Ends::open) {
  Keys result{std::move(times), std::move(rotations), {}};
  result.velocities.resize(result.times.size());
  squad_velocities(result.times, result.rotations, tension, ends, result.velocities);
  return result;
}

Keys uneven(double tension = 0) {
  std::vector<Quat> rotations;
  for (const Vec3& v : {Vec3(0.3, 0, 0.1), Vec3(1.5, 0.4, -0.3), Vec3(0.2, 1.9, 0.5),
                        Vec3(-1, 0.3, 2.2), Vec3(-1.1, 0.3, 2.2), Vec3(0, 0, 0)}) {
    rotations.push_back(from_rotation_vector(v));
  }
  return keys({0, 0.1, 1, 1.3, 3, 3.2}, rotations, tension);
}

TEST(Squad, GoesThroughItsKeysWhateverTheirSigns) {
  const Keys curve = uneven();
  Keys flipped = curve;
  for (std::size_t k = 0; k < flipped.rotations.size(); k += 2) {
    flipped.rotations[k] = negated(flipped.rotations[k]);
  }
  squad_velocities(flipped.times, flipped.rotations, 0, Ends::open, flipped.velocities);
  for (std::size_t k = 0; k < curve.times.size(); ++k) {
    EXPECT_LT(angle_between(curve.at(curve.times[k]), curve.rotations[k]), 1e-14) << k;
  }
  for (double t = 0; t <= 3.2; t += 0.05) {
    EXPECT_LT(angle_between(curve.at(t), flipped.at(t)), 1e-13) << t;
    EXPECT_NEAR(curve.at(t).norm(), 1, 1e-14);
  }
}

TEST(Squad, HasTheAngularVelocityAtItsKeysFromBothSides) {
  for (const double tension : {0.0, 0.5, -0.3}) {
    const Keys curve = uneven(tension);
    constexpr double kStep = 1e-6;
    for (std::size_t k = 1; k + 1 < curve.times.size(); ++k) {
      const Vec3 before = curve.angular_velocity(curve.times[k] - kStep, kStep);
      const Vec3 after = curve.angular_velocity(curve.times[k], kStep);
      EXPECT_LT((before - curve.velocities[k]).norm(), 3e-3) << k;
      EXPECT_LT((after - curve.velocities[k]).norm(), 3e-3) << k;
    }
  }
}

TEST(Squad, AboutOneAxisIsTheHermiteCubicOfTheAngle) {
  const Vec3 axis = Vec3(0.6, -0.2, 0.5).normalized();
  const std::vector<double> times = {0, 0.2, 1, 1.1}, angles = {0.1, 1.2, 0.4, -0.9};
  std::vector<double> rates(4);
  std::vector<Quat> rotations;
  for (const double angle : angles) rotations.push_back(from_rotation_vector(angle * axis));
  for (const double tension : {0.0, 0.4, 1.0}) {
    tension_velocities(times, angles, tension, Ends::open, rates);
    const Keys curve = keys(times, rotations, tension);
    for (double t = 0; t <= 1.1; t += 0.01) {
      const Quat expected = from_rotation_vector(sample_curve(times, angles, rates, t) * axis);
      EXPECT_LT(angle_between(curve.at(t), expected), 1e-13) << t;
    }
  }
}

TEST(Squad, ForEvenKeysHasTheUsualInnerPoints) {
  // s_i = q_i exp(-(log(q_i^-1 q_{i+1}) + log(q_i^-1 q_{i-1})) / 4), slerps of slerps.
  const Quat q0 = from_rotation_vector(Vec3(0.3, 0, 0.1)),
             q1 = from_rotation_vector(Vec3(1, 0.4, 0)),
             q2 = from_rotation_vector(Vec3(0.2, 1.2, 0.5)),
             q3 = from_rotation_vector(Vec3(0, 0.3, 1));
  const auto inner = [](const Quat& before, const Quat& at, const Quat& after) {
    // Of rotation vectors, which are twice the logarithms.
    const Vec3 sum =
        rotation_vector(at.conjugate() * after) + rotation_vector(at.conjugate() * before);
    return at * from_rotation_vector(-sum / 4);
  };
  const Quat s1 = inner(q0, q1, q2), s2 = inner(q1, q2, q3);
  const Keys curve = keys({0, 0.5, 1, 1.5}, {q0, q1, q2, q3});
  for (const double t : {0.0, 0.2, 0.5, 0.9}) {
    const Quat expected = slerp(slerp(q1, q2, t), slerp(s1, s2, t), 2 * t * (1 - t));
    EXPECT_LT(angle_between(curve.at(0.5 + 0.5 * t), expected), 1e-13) << t;
  }
}

TEST(Squad, EqualKeysRestAndHalfTurnsAreCrossed) {
  const Quat q = from_rotation_vector(Vec3(1, 2, 0));
  const Keys still = keys({0, 1, 2}, {q, negated(q), q});
  for (double t = 0; t <= 2; t += 0.1) EXPECT_LT(angle_between(still.at(t), q), 1e-14);
  // Half turns between keys: one way or the other, but at an even pace and without NaN.
  const Keys half = keys({0, 1, 2}, {Quat::Identity(), Quat(0, 0, 1, 0), Quat::Identity()});
  for (double t = 0; t <= 2; t += 0.1) {
    EXPECT_NEAR(half.at(t).norm(), 1, 1e-14);
    EXPECT_NEAR(half.at(t).x(), 0, 1e-14);
  }
}

TEST(Squad, NearlyEqualNearlyOppositeAndZeroKeysStayRotations) {
  const Quat q = from_rotation_vector(Vec3(0.2, -0.4, 1));
  for (const double angle : {1e-16, 1e-9, 1e-7, 1e-6, kPi - 1e-9, kPi - 1e-6}) {
    const Quat near = q * from_rotation_vector(Vec3(0, angle, 0));
    const Keys curve = keys({0, 0.3, 1}, {q, near, q});
    for (double t = 0; t <= 1; t += 0.05) {
      EXPECT_NEAR(curve.at(t).norm(), 1, 1e-14) << angle;
      EXPECT_LE(angle_between(q, curve.at(t)), 1.2 * angle + 1e-14) << angle << " " << t;
    }
  }
  const Keys zero = keys({0, 1, 2}, {q, Quat(0, 0, 0, 0), q});
  for (double t = 0; t <= 2; t += 0.1) EXPECT_NEAR(zero.at(t).norm(), 1, 1e-14) << t;
}

TEST(Squad, ClosedEndsMeetWithOneVelocity) {
  const Quat a = from_rotation_vector(Vec3(0.1, 0.5, 0)),
             b = from_rotation_vector(Vec3(0.4, -0.2, 0.3));
  const Keys loop =
      keys({0, 0.4, 1, 1.5}, {a, b, from_rotation_vector(Vec3(0, 0, -0.6)), negated(a)}, 0,
           Ends::closed);
  EXPECT_EQ(loop.velocities.front(), loop.velocities.back());
  constexpr double kStep = 1e-6;
  EXPECT_LT((loop.angular_velocity(0, kStep) - loop.velocities[0]).norm(), 1e-4);
  EXPECT_LT((loop.angular_velocity(1.5 - kStep, kStep) - loop.velocities[0]).norm(), 1e-4);
}

TEST(Squad, OneKeyHasNoVelocity) {
  const Keys one = keys({2}, {Quat::Identity()});
  EXPECT_EQ(one.velocities[0], Vec3::Zero());
}

TEST(Slerp, AgreesWithScipys) {
  const Quat q = slerp(from_rotation_vector(Vec3(0.3, -0.2, 0.5)),
                       from_rotation_vector(Vec3(1.1, 0.4, -0.9)), 0.3);
  const Quat expected(0.95926564, 0.27849341, -0.01221577, 0.04584353);
  EXPECT_LT(angle_between(q, normalized_or_identity(expected)), 3e-8);
}

}  // namespace
}  // namespace krok
