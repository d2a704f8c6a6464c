// If these fail, selectively damped least squares does not reach what damped least squares reaches,
// leaves limits, depends on how joints are oriented, or oscillates near singular poses.

#include <gtest/gtest.h>

#include "unit/ik/chains.h"

namespace krok::ik {
namespace {

using test::Chain;

Options selective() {
  Options options;
  options.method = Method::selectively_damped;
  options.distance = 1e-6;
  return options;
}

TEST(Selective, ReachesWhatIsInReachAndKeepsLimits) {
  test::Dice dice(31);
  int reached = 0, reached_by_damping = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Chain chain = test::bent_chain(5, dice);
    Limits limits;
    for (int j = 0; j < 5; ++j) limits.push_back(j % 2 == 0 ? dice.cone() : dice.hinge());
    // Some pose within the limits has the effector at the target.
    std::vector<Transform> local(5), there(5);
    world_to_local(chain.parents, chain.pose, local);
    for (std::size_t j = 0; j < 5; ++j) {
      local[j].orientation = clamped(limits[j], dice.rotation());
    }
    local_to_world(chain.parents, local, there);
    const Goal goal = test::reach(4, there[4].position);
    for (const bool by_damping : {false, true}) {
      Options options = selective();
      options.restarts = 10;
      if (by_damping) options.method = Method::least_squares;
      Chain moved = chain;
      Solver solver = test::solver_for(moved, limits, options);
      const bool good = (*solver.solve({&goal, 1}, moved.pose))->reached;
      (by_damping ? reached_by_damping : reached) += good ? 1 : 0;
      if (by_damping) continue;
      if (good) {
        EXPECT_LT((moved.pose[4].position - goal.target).norm(), 1e-6);
      }
      for (int j = 0; j < 5; ++j) {
        EXPECT_LE(excess(limits[at(j)], test::local_of(moved, j)), 1e-9);
      }
    }
  }
  EXPECT_GE(reached, reached_by_damping - 2);
  EXPECT_GE(reached, 190);
}

TEST(Selective, DoesNotDependOnHowJointsAreOriented) {
  test::Dice dice(32);
  for (int trial = 0; trial < 20; ++trial) {
    const Chain chain = test::bent_chain(5, dice);
    const Goal goal = test::reach(4, dice.vector(1));
    Chain plain = chain, turned = chain;
    std::vector<Quat> turns;
    for (Transform& joint : turned.pose) {
      turns.push_back(dice.rotation());
      joint.orientation = joint.orientation * turns.back();
    }
    Options options = selective();
    options.iterations = 5;
    Solver first = test::solver_for(plain, {}, options),
           second = test::solver_for(turned, {}, options);
    ASSERT_TRUE(first.solve({&goal, 1}, plain.pose).ok());
    ASSERT_TRUE(second.solve({&goal, 1}, turned.pose).ok());
    for (std::size_t j = 0; j < 5; ++j) {
      EXPECT_LT((plain.pose[j].position - turned.pose[j].position).norm(), 1e-7) << trial;
      EXPECT_LT(angle_between(plain.pose[j].orientation * turns[j], turned.pose[j].orientation),
                1e-6);
    }
  }
}

TEST(Selective, StiffJointsTurnLess) {
  const auto turn_of = [](double stiffness) {
    Chain chain = test::straight_chain(4);
    Options options = selective();
    options.stiffness = {stiffness, 0, 0, 0};
    Solver solver = test::solver_for(chain, {}, options);
    const Goal goal = test::reach(3, Vec3(0.4, 0.5, 0));
    EXPECT_TRUE((*solver.solve({&goal, 1}, chain.pose))->reached);
    return angle_between(chain.pose[0].orientation, Quat::Identity());
  };
  EXPECT_LT(turn_of(0.9), 0.7 * turn_of(0));
  EXPECT_EQ(turn_of(1), 0);
}

// A goal beyond reach: the arm stretches towards it and stays, wherever it starts.
TEST(Selective, OutOfReachTheArmStretchesAndStays) {
  test::Dice dice(33);
  for (int trial = 0; trial < 50; ++trial) {
    Chain chain = test::bent_chain(5, dice, 1.5);
    const Vec3 root = chain.pose[0].position;
    const Goal goal = test::reach(4, root + dice.between(1.25, 3) * dice.direction());
    Options options = selective();
    options.iterations = 200;
    options.restarts = 3;
    Solver solver = test::solver_for(chain, {}, options);
    ASSERT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
    EXPECT_NEAR((chain.pose[4].position - root).norm(), 1.2, 0.002) << trial;
    const Vec3 before = chain.pose[4].position;
    ASSERT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
    EXPECT_LT((chain.pose[4].position - before).norm(), 0.05) << trial;
  }
}

// A straight arm whose goal is on its line has no direction to bend in: all singular vectors along
// it vanish. Nothing may become infinite.
TEST(Selective, SingularPosesStayFinite) {
  for (const double height : {0.3, 0.9, 1.5}) {
    Chain chain = test::straight_chain(4);
    const Goal goal = test::reach(3, Vec3(0, height, 0));
    Solver solver = test::solver_for(chain, {}, selective());
    ASSERT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
    for (const Transform& joint : chain.pose) {
      EXPECT_TRUE(joint.position.allFinite() && joint.orientation.coeffs().allFinite());
    }
  }
}

}  // namespace
}  // namespace krok::ik
