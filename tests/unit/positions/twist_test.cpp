// If these fail, a chain flips where what it carries turns by more than half a turn against what
// carries it: its joints take a share of that angle, which must go on beyond half a turn. Or bones
// behind a joint that turns about one axis, as in a robot's hip, turn about themselves with it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "math/quaternion.h"
#include "positions/from_positions.h"

namespace krok {
namespace {

TEST(PositionTwist, AChainTurnsOnBeyondHalfATurn) {
  constexpr int kSteps = 90;
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
  for (int f = 0; f < kSteps; ++f) {
    // From -60 to 300 degrees.
    const double angle = kPi * (2.0 * f / (kSteps - 1) - 1.0 / 3);
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
  for (int f = 1; f < kSteps; ++f) {
    largest = std::max(largest, angle_between(link(f - 1), link(f)));
  }
  EXPECT_LT(largest, 5 * kRadiansPerDegree);
}

TEST(PositionTwist, AHipOfSeveralHingesDoesNotTwist) {
  constexpr int kSteps = 60;
  Skeleton skeleton;
  const std::vector<Vec3> places = {{0, 0, 0},         {-0.1, 0, 0},     {0, 0.2, 0},
                                    {0.06, -0.1, 0},   {0.11, -0.13, 0}, {0.11, -0.25, 0.02},
                                    {0.11, -0.6, 0.02}};
  const int parents[] = {-1, 0, 0, 0, 3, 4, 5};
  for (std::size_t j = 0; j < places.size(); ++j) {
    skeleton.add("joint" + std::to_string(j), parents[j], {Vec3::Zero(), Quat::Identity()});
  }
  std::vector<Vec3> positions;
  for (int f = 0; f < kSteps; ++f) {
    // The leg swings by 60 degrees about the axis of the hip's first hinge.
    const Quat swing = from_rotation_vector(-kPi / 3 * std::sin(0.1 * f) * Vec3::UnitX());
    for (std::size_t j = 0; j < places.size(); ++j) {
      positions.push_back(j < 4 ? places[j] : places[3] + swing * (places[j] - places[3]));
    }
  }
  RoleMap roles;
  roles.roles.assign(places.size(), Role::none);
  const PoseFromPositions made = from_positions({skeleton, roles, positions});
  double twist = 0;
  for (int f = 1; f < kSteps; ++f) {
    const auto turn = [&](int frame) -> Quat {
      return made.clip.frame_orientations(frame)[4].cast<double>();
    };
    const Quat step = turn(f) * turn(f - 1).conjugate();
    const Vec3 bone =
        (made.clip.frame_positions(f)[5] - made.clip.frame_positions(f)[4]).cast<double>();
    twist = std::max(twist, 2 * std::abs(step.vec().dot(bone.normalized())));
  }
  EXPECT_LT(twist, 0.3 * kRadiansPerDegree);
}

}  // namespace
}  // namespace krok
