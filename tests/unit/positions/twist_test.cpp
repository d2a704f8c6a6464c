// If this fails, a chain flips where what it carries turns by more than half a turn against what
// carries it: its joints take a share of that angle, which must go on beyond half a turn.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "math/quaternion.h"
#include "positions/from_positions.h"

namespace krok {
namespace {

TEST(PositionTwist, AChainTurnsOnBeyondHalfATurn) {
  constexpr int kFrames = 90;
  Skeleton skeleton;
  const auto add = [&](const char* name, int parent, const Vec3& place) {
    return skeleton.add(name, parent, {place, Quat::Identity()});
  };
  add("base", -1, Vec3::Zero());
  add("left_of_base", 0, {0.2, 0, 0});
  add("right_of_base", 0, {-0.2, 0, 0});
  add("link", 0, {0, 0.3, 0});
  add("top", 3, {0, 0.6, 0});
  add("left_of_top", 4, {0.2, 0.6, 0});
  add("right_of_top", 4, {-0.2, 0.6, 0});
  add("above_top", 4, {0, 0.8, 0});
  std::vector<Vec3> positions;
  for (int f = 0; f < kFrames; ++f) {
    // From -60 to 300 degrees.
    const double angle = kPi * (2.0 * f / (kFrames - 1) - 1.0 / 3);
    for (int j = 0; j < 8; ++j) {
      const Vec3& place = skeleton.reference[static_cast<std::size_t>(j)].position;
      positions.push_back(j < 5 ? place : from_rotation_vector(angle * Vec3::UnitY()) * place);
    }
  }
  RoleMap roles;
  roles.roles.assign(8, Role::none);
  const PoseFromPositions made = from_positions({skeleton, roles, positions});
  EXPECT_LT(made.largest, 1e-5);
  const auto link = [&](int f) -> Quat {
    return made.clip.frame_orientations(f)[3].cast<double>();
  };
  double largest = 0;
  for (int f = 1; f < kFrames; ++f) {
    largest = std::max(largest, angle_between(link(f - 1), link(f)));
  }
  EXPECT_LT(largest, 5 * kRadiansPerDegree);
}

}  // namespace
}  // namespace krok
