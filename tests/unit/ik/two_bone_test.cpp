// If these fail, feet and hands miss the places they are sent to, knees bend sideways or snap, or
// an unreachable or degenerate target brings NaN into a pose.

#include "ik/two_bone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "math/quaternion.h"

namespace krok {
namespace {

// A leg of a figure facing +Z in its reference pose: straight down, the knee hinges about +X.
TwoBoneChain leg(double thigh = 0.43, double shank = 0.41) {
  TwoBoneChain chain;
  chain.root = Vec3(0.1, 0.9, -0.2);
  chain.middle = chain.root + Vec3(0, -thigh, 0);
  chain.end = chain.middle + Vec3(0, -shank, 0);
  chain.hinge = Vec3::UnitX();
  return chain;
}

TwoBoneGoal goal(const Vec3& target, const Vec3& pole = Vec3::UnitZ()) {
  TwoBoneGoal result;
  result.target = target;
  result.pole = pole;
  return result;
}

// What must hold whatever the input was: lengths kept, finite, the rotations lead where the points
// say, the bend is the angle between the bones.
void expect_consistent(const TwoBoneChain& chain, const TwoBoneSolution& solution) {
  ASSERT_TRUE(solution.middle.allFinite() && solution.end.allFinite());
  const Vec3 upper = chain.middle - chain.root;
  const Vec3 lower = chain.end - chain.middle;
  EXPECT_NEAR((solution.middle - chain.root).norm(), upper.norm(), 1e-9);
  EXPECT_NEAR((solution.end - solution.middle).norm(), lower.norm(), 1e-9);
  EXPECT_NEAR(solution.root_rotation.norm(), 1, 1e-12);
  EXPECT_NEAR(solution.middle_rotation.norm(), 1, 1e-12);
  EXPECT_LT((chain.root + solution.root_rotation * upper - solution.middle).norm(), 1e-7);
  EXPECT_LT((solution.middle + solution.middle_rotation * lower - solution.end).norm(), 1e-7);
  EXPECT_GE(solution.bend, 0);
  EXPECT_LE(solution.bend, kPi);
}

TEST(TwoBone, ReachesWhatIsInReachAndKeepsTheBonesLengths) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const auto vector = [&] {
    return Vec3(coordinate(random), coordinate(random), coordinate(random));
  };
  for (int i = 0; i < 2000; ++i) {
    TwoBoneChain chain{vector(), vector(), vector(), i % 2 ? vector() : Vec3(Vec3::Zero())};
    const double upper = (chain.middle - chain.root).norm();
    const double lower = (chain.end - chain.middle).norm();
    const Vec3 target = chain.root + vector();
    const TwoBoneSolution solution = solve_two_bone(chain, goal(target, vector()));
    expect_consistent(chain, solution);
    const double distance = (target - chain.root).norm();
    const bool in_reach = distance <= upper + lower && distance >= std::abs(upper - lower);
    EXPECT_EQ(solution.reached, in_reach) << i;
    if (in_reach) {
      EXPECT_LT((solution.end - target).norm(), 1e-9);
    }
  }
}

TEST(TwoBone, TheKneePointsWhereThePoleSays) {
  const TwoBoneChain chain = leg();
  for (double degrees : {-80.0, -20.0, 0.0, 35.0, 89.0}) {
    const double angle = degrees * kRadiansPerDegree;
    const Vec3 pole(std::sin(angle), 0, std::cos(angle));
    const TwoBoneSolution solution =
        solve_two_bone(chain, goal(chain.root + Vec3(0, -0.6, 0), pole));
    Vec3 out = solution.middle - chain.root;
    out.y() = 0;
    EXPECT_GT(out.normalized().dot(pole), 1 - 1e-12);
    // The thigh turns with the knee: its hinge stays square to the plane of the leg.
    EXPECT_LT((solution.root_rotation * chain.hinge - pole.cross(Vec3(0, -1, 0))).norm(), 1e-9);
    EXPECT_LT((solution.middle_rotation * chain.hinge - pole.cross(Vec3(0, -1, 0))).norm(), 1e-9);
  }
}

TEST(TwoBone, AChainThatIsAlreadyThereDoesNotTurn) {
  TwoBoneChain chain = leg();
  chain.middle += Vec3(0, 0.05, 0.2);
  for (const Vec3& hinge : {Vec3(Vec3::Zero()), Vec3(Vec3::UnitX())}) {
    chain.hinge = hinge;
    const TwoBoneSolution solution = solve_two_bone(chain, goal(chain.end));
    EXPECT_LT(angle_between(solution.root_rotation, Quat::Identity()), 1e-7);
    EXPECT_LT(angle_between(solution.middle_rotation, Quat::Identity()), 1e-7);
    EXPECT_TRUE(solution.reached);
  }
}

TEST(TwoBone, ATargetTooFarStraightensTheChainTowardsIt) {
  const TwoBoneChain chain = leg();
  const Vec3 direction = Vec3(1, -2, 0.5).normalized();
  const TwoBoneSolution solution = solve_two_bone(chain, goal(chain.root + direction * 3));
  expect_consistent(chain, solution);
  EXPECT_FALSE(solution.reached);
  EXPECT_LT((solution.end - (chain.root + direction * 0.84)).norm(), 1e-9);
  EXPECT_NEAR(solution.bend, 0, 1e-7);
}

TEST(TwoBone, ATargetTooNearFoldsTheChain) {
  const TwoBoneChain chain = leg(0.5, 0.3);
  const TwoBoneSolution solution = solve_two_bone(chain, goal(chain.root + Vec3(0, -0.1, 0)));
  expect_consistent(chain, solution);
  EXPECT_FALSE(solution.reached);
  EXPECT_NEAR((solution.end - chain.root).norm(), 0.2, 1e-9);
  EXPECT_NEAR(solution.bend, kPi, 1e-7);
}

TEST(TwoBone, ATargetAtTheRootIsReachedByEqualBones) {
  const TwoBoneChain chain = leg(0.4, 0.4);
  const TwoBoneSolution solution = solve_two_bone(chain, goal(chain.root));
  expect_consistent(chain, solution);
  EXPECT_TRUE(solution.reached);
  const TwoBoneChain unequal = leg(0.5, 0.3);
  const TwoBoneSolution kept = solve_two_bone(unequal, goal(unequal.root));
  expect_consistent(unequal, kept);
  EXPECT_LT((kept.end - (unequal.root + Vec3(0, -0.2, 0))).norm(), 1e-9) << "the present direction";
}

TEST(TwoBone, LimitsOfTheBendLimitTheReach) {
  const TwoBoneChain chain = leg();
  TwoBoneGoal far = goal(chain.root + Vec3(0, -2, 0));
  far.min_bend = 10 * kRadiansPerDegree;
  far.max_bend = 120 * kRadiansPerDegree;
  const TwoBoneSolution stretched = solve_two_bone(chain, far);
  expect_consistent(chain, stretched);
  EXPECT_NEAR(stretched.bend, far.min_bend, 1e-9);
  EXPECT_NEAR((stretched.end - chain.root).norm(), two_bone_reach(0.43, 0.41, far.min_bend), 1e-12);
  TwoBoneGoal near = far;
  near.target = chain.root + Vec3(0, -0.05, 0);
  const TwoBoneSolution folded = solve_two_bone(chain, near);
  expect_consistent(chain, folded);
  EXPECT_NEAR(folded.bend, near.max_bend, 1e-9);
}

TEST(TwoBone, SoftnessLetsTheKneeStraightenWithoutASnap) {
  const TwoBoneChain chain = leg();
  // The end is drawn away at even speed. Without softness the bend ends in a corner; with it no
  // step of the bend is larger than the ones before by much.
  const auto largest_step = [&](double softness) {
    double largest = 0;
    double previous = -1;
    for (double distance = 0.7; distance < 0.9; distance += 0.001) {
      TwoBoneGoal away = goal(chain.root + Vec3(0, -distance, 0));
      away.softness = softness;
      const TwoBoneSolution solution = solve_two_bone(chain, away);
      expect_consistent(chain, solution);
      if (previous >= 0) largest = std::max(largest, std::abs(solution.bend - previous));
      previous = solution.bend;
    }
    return largest;
  };
  EXPECT_LT(largest_step(0.04), 0.35 * largest_step(0));
}

TEST(TwoBone, APoleAlongTheLineOrNoPoleFallsBackOnThePresentBend) {
  TwoBoneChain chain = leg();
  chain.middle += Vec3(0.2, 0.05, 0);
  chain.hinge = Vec3::Zero();
  for (const Vec3& pole : {Vec3(Vec3::Zero()), Vec3(0, 1, 0), Vec3(0, -5, 0)}) {
    const TwoBoneSolution solution =
        solve_two_bone(chain, goal(chain.root + Vec3(0, -0.5, 0), pole));
    expect_consistent(chain, solution);
    EXPECT_TRUE(solution.reached);
    EXPECT_GT(solution.middle.x() - chain.root.x(), 0.1);
  }
  // A straight chain has no bend: its hinge decides, and without one any plane will do.
  TwoBoneChain straight = leg();
  const TwoBoneSolution hinged =
      solve_two_bone(straight, goal(straight.root + Vec3(0, -0.5, 0), Vec3::Zero()));
  expect_consistent(straight, hinged);
  EXPECT_GT(hinged.middle.z() - straight.root.z(), 0.1) << "a knee bends forward";
  straight.hinge = Vec3::Zero();
  const TwoBoneSolution any =
      solve_two_bone(straight, goal(straight.root + Vec3(0, -0.5, 0), Vec3::Zero()));
  expect_consistent(straight, any);
  EXPECT_TRUE(any.reached);
}

TEST(TwoBone, BonesOfNoLength) {
  const TwoBoneChain no_thigh = leg(0, 0.4);
  const TwoBoneSolution one = solve_two_bone(no_thigh, goal(no_thigh.root + Vec3(0.4, 0, 0)));
  expect_consistent(no_thigh, one);
  EXPECT_TRUE(one.reached);
  const TwoBoneChain no_shank = leg(0.4, 0);
  const TwoBoneSolution other = solve_two_bone(no_shank, goal(no_shank.root + Vec3(0, 0, 2)));
  expect_consistent(no_shank, other);
  EXPECT_FALSE(other.reached);
  const TwoBoneChain none = leg(0, 0);
  const TwoBoneSolution nothing = solve_two_bone(none, goal(none.root + Vec3(0, 0, 2)));
  EXPECT_EQ(nothing.end, none.end);
  EXPECT_FALSE(nothing.reached);
  EXPECT_TRUE(solve_two_bone(none, goal(none.root)).reached);
}

TEST(TwoBone, ValuesThatAreNotFiniteLeaveTheChainAsItIs) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity()};
  for (double value : bad) {
    const TwoBoneChain chain = leg();
    const TwoBoneSolution solution = solve_two_bone(chain, goal(Vec3(0, value, 0)));
    EXPECT_EQ(solution.middle, chain.middle);
    EXPECT_EQ(solution.end, chain.end);
    EXPECT_EQ(solution.root_rotation.coeffs(), Quat::Identity().coeffs());
    EXPECT_FALSE(solution.reached);
  }
}

TEST(TwoBone, ReachAndBendAreInverse) {
  for (double bend : {0.01, 0.5, 1.5, 2.5, 3.1}) {
    EXPECT_NEAR(two_bone_bend(0.4, 0.3, two_bone_reach(0.4, 0.3, bend)), bend, 1e-9);
  }
  EXPECT_NEAR(two_bone_reach(0.4, 0.3, 0), 0.7, 1e-15);
  EXPECT_NEAR(two_bone_reach(0.4, 0.3, kPi), 0.1, 1e-12);
  EXPECT_EQ(two_bone_bend(0.4, 0.3, 5), 0);
  EXPECT_NEAR(two_bone_bend(0.4, 0.3, 0), kPi, 1e-15);
}

}  // namespace
}  // namespace krok
