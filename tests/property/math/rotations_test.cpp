// Properties of all rotations, tested on random ones (fixed seed). If one fails, some rotation is
// wrong that the unit tests do not cover.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "math/quaternion.h"
#include "scene/skeleton.h"

namespace krok {
namespace {

class Rotations : public testing::Test {
 protected:
  static constexpr int kRounds = 3000;

  double number() { return normal_(random_); }
  Vec3 vector() { return {number(), number(), number()}; }
  Quat rotation() { return normalized_or_identity(Quat(number(), number(), number(), number())); }
  double share() { return std::uniform_real_distribution<>(0, 1)(random_); }

  std::mt19937_64 random_{20240607};
  std::normal_distribution<> normal_;
};

TEST_F(Rotations, SlerpDividesTheAngle) {
  for (int i = 0; i < kRounds; ++i) {
    const Quat a = rotation(), b = rotation();
    const double t = share();
    const Quat q = slerp(a, b, t);
    const double angle = angle_between(a, b);
    EXPECT_NEAR(q.norm(), 1, 1e-14);
    EXPECT_NEAR(angle_between(a, q), t * angle, 1e-12);
    EXPECT_NEAR(angle_between(q, b), (1 - t) * angle, 1e-12);
    EXPECT_LT(angle_between(slerp(b, a, 1 - t), q), 1e-12);
  }
}

TEST_F(Rotations, RotationVectorsAreUndone) {
  for (int i = 0; i < kRounds; ++i) {
    const Quat q = rotation();
    const Vec3 v = rotation_vector(q);
    EXPECT_LE(v.norm(), kPi + 1e-15);
    EXPECT_LT(angle_between(from_rotation_vector(v), q), 1e-14);
  }
}

TEST_F(Rotations, EulerAnglesComposeBack) {
  const EulerOrder orders[] = {{Axis::x, Axis::y, Axis::z}, {Axis::x, Axis::z, Axis::y},
                               {Axis::y, Axis::x, Axis::z}, {Axis::y, Axis::z, Axis::x},
                               {Axis::z, Axis::x, Axis::y}, {Axis::z, Axis::y, Axis::x}};
  for (int i = 0; i < kRounds; ++i) {
    const Quat q = rotation();
    const Vec3 previous = 10 * vector();
    for (const EulerOrder& order : orders) {
      const Vec3 angles = to_euler(q, order);
      const Vec3 close = closest_euler(angles, previous);
      for (const Vec3& each : {angles, close}) {
        EXPECT_LT(angle_between(from_axis_rotations(order, std::span(each.data(), 3)), q), 1e-9);
      }
      EXPECT_LE((close - previous).norm(), (angles - previous).norm() + 1e-12);
    }
  }
}

TEST_F(Rotations, ShortestArcTurnsAboutThePerpendicular) {
  for (int i = 0; i < kRounds; ++i) {
    const Vec3 from = vector(), to = vector();
    const Quat q = shortest_arc(from, to);
    EXPECT_LT((q * from.normalized() - to.normalized()).norm(), 1e-13);
    EXPECT_NEAR(q.vec().dot(from), 0, 1e-12);
  }
}

TEST_F(Rotations, PosesGoToTheWorldAndBack) {
  for (int i = 0; i < 200; ++i) {
    constexpr int kJoints = 40;
    std::vector<int> parents;
    std::vector<Transform> local, world(kJoints), back(kJoints);
    for (int j = 0; j < kJoints; ++j) {
      parents.push_back(j == 0 ? -1 : static_cast<int>(random_() % static_cast<unsigned>(j)));
      local.push_back({vector(), rotation()});
    }
    local_to_world(parents, local, world);
    world_to_local(parents, world, back);
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_LT((back[j].position - local[j].position).norm(), 1e-12);
      EXPECT_LT(angle_between(back[j].orientation, local[j].orientation), 1e-12);
    }
  }
}

}  // namespace
}  // namespace krok
