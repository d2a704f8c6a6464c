// If these fail, cyclic coordinate descent ignores what the source describes: goals and chains,
// stiffness, depth, threshold, iterations, limits.

#include <gtest/gtest.h>

#include "unit/ik/chains.h"

namespace krok::ik {
namespace {

using test::Chain;

Options ccd(int iterations = 200) {
  Options options;
  options.method = Method::ccd;
  options.iterations = iterations;
  return options;
}

TEST(Ccd, ReachesGoalsOfSeveralChains) {
  // Two arms of four joints on one trunk joint.
  Chain body = test::straight_chain(2);
  for (const int side : {1, -1}) {
    for (int k = 0; k < 4; ++k) {
      body.parents.push_back(k == 0 ? 1 : static_cast<int>(body.pose.size()) - 1);
      body.pose.push_back({Vec3(0.3 * side * (k + 1), 0.4, 0.05 * (k % 2)), Quat::Identity()});
    }
  }
  const std::vector<Goal> goals = {test::reach(5, Vec3(0.7, 0.9, 0.3)),
                                   test::reach(9, Vec3(-0.5, 0.0, 0.4))};
  Solver solver = test::solver_for(body, {}, ccd());
  const auto outcome = solver.solve(goals, body.pose);
  ASSERT_TRUE(outcome.ok());
  EXPECT_TRUE((*outcome)->reached);
  EXPECT_LT((body.pose[5].position - goals[0].target).norm(), 1e-4);
  EXPECT_LT((body.pose[9].position - goals[1].target).norm(), 1e-4);
}

TEST(Ccd, ReachesOrientationsPosesAndPlacesToLookAt) {
  test::Dice dice(21);
  for (const auto kind : {Goal::Kind::orientation, Goal::Kind::pose, Goal::Kind::look_at}) {
    Chain chain = test::bent_chain(6, dice);
    Goal goal;
    goal.kind = kind;
    goal.joint = 5;
    goal.target = Vec3(0.4, 0.8, 0.5);
    goal.orientation = dice.rotation(1);
    goal.axis = Vec3::UnitY();
    Solver solver = test::solver_for(chain, {}, ccd());
    EXPECT_TRUE((*solver.solve({&goal, 1}, chain.pose))->reached) << static_cast<int>(kind);
  }
}

TEST(Ccd, StiffnessScalesEachJointsTurn) {
  const auto turn_of = [](double stiffness) {
    Chain chain = test::straight_chain(2);
    Options options = ccd(1);
    options.stiffness = {stiffness, 0};
    Solver solver = test::solver_for(chain, {}, options);
    const Goal goal = test::reach(1, Vec3(0.3, 0, 0));
    EXPECT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
    return angle_between(chain.pose[0].orientation, Quat::Identity());
  };
  EXPECT_NEAR(turn_of(0), kPi / 2, 1e-9);
  EXPECT_NEAR(turn_of(0.75), kPi / 8, 1e-9);
  EXPECT_EQ(turn_of(1), 0);
}

TEST(Ccd, DepthSaysHowManyJointsTakePart) {
  for (int depth = 1; depth <= 5; ++depth) {
    Chain chain = test::straight_chain(6);
    Goal goal = test::reach(5, Vec3(0.4, 0.9, 0.2));
    goal.depth = depth;
    Solver solver = test::solver_for(chain, {}, ccd());
    ASSERT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
    // The effector's own joint is the first; turning it does not move its position.
    for (int j = 0; j < 5; ++j) {
      const double turned = angle_between(test::local_of(chain, j), Quat::Identity());
      if (j < 6 - depth) {
        EXPECT_EQ(turned, 0) << depth << " " << j;
      } else {
        EXPECT_GT(turned, 1e-4) << depth << " " << j;
      }
    }
  }
}

TEST(Ccd, StopsAtTheThresholdOrAtTheIterationLimit) {
  const auto solve = [](int iterations, double threshold) {
    Chain chain = test::straight_chain(6);
    Options options = ccd(iterations);
    options.distance = threshold;
    Solver solver = test::solver_for(chain, {}, options);
    const Goal goal = test::reach(5, Vec3(0.4, 0.5, 0.6));
    const Outcome outcome = **solver.solve({&goal, 1}, chain.pose);
    return std::pair(outcome.iterations, outcome.goals[0].distance);
  };
  const auto rough = solve(500, 0.05), fine = solve(500, 1e-6), cut = solve(1, 1e-6);
  EXPECT_LT(rough.first, fine.first);
  EXPECT_LE(rough.second, 0.05);
  EXPECT_GT(rough.second, 1e-6);
  EXPECT_LE(fine.second, 1e-6);
  EXPECT_EQ(cut.first, 1);
  EXPECT_GT(cut.second, 1e-6);
}

TEST(Ccd, KeepsLimitsByDegreesOfFreedom) {
  test::Dice dice(22);
  for (int trial = 0; trial < 100; ++trial) {
    Chain chain = test::bent_chain(5, dice);
    Limits limits;
    for (int j = 0; j < 5; ++j) limits.push_back(j % 2 == 0 ? dice.cone() : dice.hinge());
    const Goal goal = test::reach(4, dice.vector(1.2));
    Solver solver = test::solver_for(chain, limits, ccd(50));
    ASSERT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
    for (int j = 0; j < 5; ++j) {
      EXPECT_LE(excess(limits[at(j)], test::local_of(chain, j)), 1e-9);
    }
  }
}

TEST(LimbMethod, IsTheClosedFormAndTurnsTheEnd) {
  test::Dice dice(23);
  for (int trial = 0; trial < 100; ++trial) {
    Chain chain = test::bent_chain(4, dice, 1.0);
    const Vec3 root = chain.pose[1].position;
    Goal goal;
    goal.kind = Goal::Kind::pose;
    goal.joint = 3;
    goal.target = root + dice.between(0.1, 0.55) * dice.direction();
    goal.orientation = dice.rotation();
    Options options;
    options.method = Method::two_bone;
    Solver solver = test::solver_for(chain, {}, options);
    const Outcome outcome = **solver.solve({&goal, 1}, chain.pose);
    EXPECT_TRUE(outcome.reached) << outcome.goals[0].distance << " " << outcome.goals[0].angle;
  }
}

TEST(LimbMethod, BendsTowardsThePole) {
  Chain chain = test::straight_chain(3);
  std::vector<Goal> goals = {test::reach(2, Vec3(0, 0.4, 0)), {}};
  goals[1].kind = Goal::Kind::pole;
  goals[1].joint = 1;
  goals[1].target = Vec3(1, 0.2, 1);
  Options options;
  options.method = Method::two_bone;
  Solver solver = test::solver_for(chain, {}, options);
  const Outcome outcome = **solver.solve(goals, chain.pose);
  EXPECT_TRUE(outcome.reached);
  EXPECT_GT(chain.pose[1].position.x(), 0.05);
  EXPECT_NEAR(chain.pose[1].position.x(), chain.pose[1].position.z(), 1e-9);
}

}  // namespace
}  // namespace krok::ik
