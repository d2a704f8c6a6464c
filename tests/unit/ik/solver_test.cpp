// If these fail, least squares misses goals it could reach, leaves limits, moves joints it should
// leave alone, or gives another result on another run.

#include "ik/solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ik/tree_internal.h"
#include "unit/ik/chains.h"

namespace krok::ik {
namespace {

using test::Chain;
using test::Dice;

std::vector<Goal> goals_of_all_kinds(Dice& dice, int last) {
  std::vector<Goal> goals(6);
  for (int k = 0; k < 6; ++k) {
    goals[at(k)].kind = static_cast<Goal::Kind>(k);
    goals[at(k)].joint = last;
    goals[at(k)].point = dice.vector(0.2);
    goals[at(k)].target = dice.vector(1.5);
    goals[at(k)].orientation = dice.rotation();
    goals[at(k)].axis = dice.direction();
    goals[at(k)].weight = dice.between(0.5, 2);
  }
  goals[4].joint = last - 2;
  goals[4].upper = last - 4;
  goals[4].lower = last - 1;
  goals[5].support = {Vec2(3, 3), Vec2(4, 3), Vec2(3, 4)};
  return goals;
}

TEST(IkSolver, DerivativesAreTheChangeOfTheErrors) {
  Dice dice(5);
  constexpr int kJoints = 6;
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 60; ++trial) {
    const Chain chain = test::bent_chain(kJoints, dice, 1.2);
    auto goals = goals_of_all_kinds(dice, kJoints - 1);
    Options options;
    options.masses.assign(kJoints, 1.5);
    options.mass_centres.assign(kJoints, dice.vector(0.1));
    // Where the error vanishes the turn of an axis and the change of a rotation vector are the same
    // to first order, so goals of rotation are put near the pose.
    goals[1].orientation = goals[2].orientation = chain.pose.back().orientation;
    goals[3].target = chain.pose.back() * Vec3(goals[3].point + 0.7 * goals[3].axis);
    Tree tree;
    tree.prepare(chain.parents);
    tree.collect(goals, {}, options, chain.pose);
    std::vector<double> before(at(tree.rows)), more(at(tree.rows)), less(at(tree.rows));
    for (int j = 0; j < kJoints; ++j) {
      for (int k = 0; k < 4; ++k) {
        Freedom freedom;
        freedom.joint = k == 3 ? 0 : j;
        freedom.shift = k == 3;
        const ChainJoint& joint = tree.joints[at(freedom.joint)];
        freedom.world = k == 3 ? dice.direction() : Vec3(joint.world.orientation * Vec3::Unit(k));
        std::vector<double> column(at(tree.rows), 0.0);
        for (const GoalRows& goal : tree.goals) {
          const auto begin = tree.path.begin() + goal.first_path;
          const auto end = begin + goal.paths;
          if (std::find(begin, end, freedom.joint) == end) continue;
          tree.column(goal, freedom, column.data());
        }
        const ChainJoint kept = joint;
        const auto moved = [&](double step, std::vector<double>& errors) {
          ChainJoint& moving = tree.joints[at(freedom.joint)];
          if (freedom.shift) moving.offset += step * freedom.world;
          if (!freedom.shift)
            moving.local = kept.local * from_rotation_vector(step * Vec3::Unit(k));
          tree.forward();
          tree.errors(errors);
          tree.joints[at(freedom.joint)] = kept;
          tree.forward();
        };
        moved(kStep, more);
        moved(-kStep, less);
        for (std::size_t r = 0; r < column.size(); ++r) {
          EXPECT_NEAR(column[r], -(more[r] - less[r]) / (2 * kStep),
                      2e-5 * (1 + std::abs(column[r])))
              << "row " << r << " joint " << j << " axis " << k;
        }
      }
    }
  }
}

TEST(IkSolver, ReachesPosesAChainCanTakeAndKeepsItsBonesAndLimits) {
  Dice dice(6);
  int reached = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const int joints = 4 + trial % 4;
    const Chain chain = test::straight_chain(joints);
    Limits limits;
    std::vector<Transform> local(chain.pose.size()), wanted(chain.pose.size());
    world_to_local(chain.parents, chain.pose, local);
    Chain start = chain;
    for (int j = 0; j < joints; ++j) {
      limits.push_back(j % 3 == 2 ? dice.hinge() : dice.cone());
      local[at(j)].orientation = clamped(limits.back(), dice.rotation(2.5));
    }
    local_to_world(chain.parents, local, wanted);
    for (Transform& one : local) one.orientation = dice.rotation(2.5);
    local_to_world(chain.parents, local, start.pose);
    Options options;
    options.restarts = 30;
    Solver solver = test::solver_for(start, limits, options);
    const Goal goal = test::reach(joints - 1, wanted.back().position);
    const auto outcome = solver.solve({&goal, 1}, start.pose);
    ASSERT_TRUE(outcome.ok());
    reached += (*outcome)->reached ? 1 : 0;
    EXPECT_EQ((*outcome)->reached, (start.pose.back().position - goal.target).norm() <= 1e-4);
    for (int j = 0; j < joints; ++j) {
      EXPECT_LE(excess(limits[at(j)], test::local_of(start, j)), 1e-9);
      if (j > 0) {
        EXPECT_NEAR((start.pose[at(j)].position - start.pose[at(j - 1)].position).norm(), 0.3,
                    1e-12);
      }
    }
  }
  EXPECT_GE(reached, kTrials * 98 / 100);
}

// Five goals of different kinds that one pose fulfils, found from another one.
TEST(IkSolver, BringsAboutSeveralGoalsAtOnce) {
  Dice dice(7);
  int reached = 0;
  constexpr int kTrials = 100;
  for (int trial = 0; trial < kTrials; ++trial) {
    // A trunk of three joints with two arms of four.
    Chain body = test::straight_chain(3);
    for (const int side : {1, -1}) {
      for (int k = 0; k < 4; ++k) {
        body.parents.push_back(k == 0 ? 2 : static_cast<int>(body.pose.size()) - 1);
        body.pose.push_back({Vec3(0.3 * side * (k + 1), 0.7, 0), Quat::Identity()});
      }
    }
    std::vector<Transform> local(body.pose.size()), wanted(body.pose.size());
    world_to_local(body.parents, body.pose, local);
    for (Transform& one : local) one.orientation = dice.rotation(0.7);
    local_to_world(body.parents, local, wanted);
    std::vector<Goal> goals(5);
    goals[0] = test::reach(6, wanted[6].position);
    goals[1].kind = Goal::Kind::pose;
    goals[1].joint = 10;
    goals[1].target = wanted[10].position;
    goals[1].orientation = wanted[10].orientation;
    goals[2].kind = Goal::Kind::look_at;
    goals[2].joint = 2;
    goals[2].target = wanted[2] * Vec3(0, 0, 2);
    goals[3].kind = Goal::Kind::pole;
    goals[3].joint = 4;
    goals[3].lower = 6;
    goals[3].target = wanted[4].position;
    goals[4].kind = Goal::Kind::orientation;
    goals[4].joint = 6;
    goals[4].orientation = wanted[6].orientation;
    Options options;
    options.restarts = 5;
    Solver solver = test::solver_for(body, {}, options);
    const auto outcome = solver.solve(goals, body.pose);
    ASSERT_TRUE(outcome.ok());
    reached += (*outcome)->reached ? 1 : 0;
    const auto missed = residuals(goals, body.parents, body.pose, options);
    for (std::size_t g = 0; g < goals.size(); ++g) {
      EXPECT_NEAR(missed[g].distance, (*outcome)->goals[g].distance, 1e-9);
      EXPECT_NEAR(missed[g].angle, (*outcome)->goals[g].angle, 1e-7);
    }
  }
  EXPECT_GE(reached, kTrials - 2);
}

TEST(IkSolver, TheCentreOfMassComesOverItsSupport) {
  Dice dice(8);
  Chain chain = test::bent_chain(5, dice, 0.8);
  Options options;
  options.masses.assign(5, 2.0);
  options.distance = 1e-6;
  std::vector<Goal> goals(1);
  goals[0].kind = Goal::Kind::balance;
  goals[0].support = {Vec2(-0.05, -0.05), Vec2(0.05, -0.05), Vec2(0.05, 0.05), Vec2(-0.05, 0.05)};
  Solver solver = test::solver_for(chain, {}, options);
  const auto outcome = solver.solve(goals, chain.pose);
  ASSERT_TRUE(outcome.ok());
  EXPECT_TRUE((*outcome)->reached);
  Vec3 centre = Vec3::Zero();
  for (const Transform& joint : chain.pose) centre += joint.position / 5;
  EXPECT_LE(std::abs(centre.x()), 0.05 + 1e-5);
  EXPECT_LE(std::abs(centre.z()), 0.05 + 1e-5);
}

TEST(IkSolver, WhatIsReachedAlreadyStaysAndWhatHangsOnTheChainFollows) {
  Dice dice(9);
  Chain chain = test::bent_chain(5, dice);
  // A joint beside the chain's third, and one below its last.
  chain.parents.push_back(2);
  chain.pose.push_back(chain.pose[2] * Transform{Vec3(0.1, 0, 0), dice.rotation()});
  chain.parents.push_back(4);
  chain.pose.push_back(chain.pose[4] * Transform{Vec3(0, 0.1, 0), dice.rotation()});
  const auto before = chain.pose;
  Solver solver = test::solver_for(chain);
  Goal goal = test::reach(4, chain.pose[4].position);
  ASSERT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
  for (std::size_t j = 0; j < before.size(); ++j) {
    EXPECT_LT((chain.pose[j].position - before[j].position).norm(), 1e-14);
    EXPECT_LT(angle_between(chain.pose[j].orientation, before[j].orientation), 1e-14);
  }
  goal.target += Vec3(0.1, -0.2, 0.05);
  ASSERT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
  for (const auto& [child, parent] : {std::pair(5, 2), std::pair(6, 4)}) {
    const Transform then = before[at(parent)].inverse() * before[at(child)];
    const Transform now = chain.pose[at(parent)].inverse() * chain.pose[at(child)];
    EXPECT_LT((then.position - now.position).norm(), 1e-12);
    EXPECT_LT(angle_between(then.orientation, now.orientation), 1e-12);
  }
}

// The world's axes mean nothing to a chain.
TEST(IkSolver, TurningEverythingTurnsTheSolution) {
  Dice dice(10);
  for (int trial = 0; trial < 20; ++trial) {
    Chain chain = test::bent_chain(5, dice);
    const Transform move{dice.vector(5), dice.rotation()};
    Chain moved = chain;
    for (Transform& joint : moved.pose) joint = move * joint;
    Goal goal = test::reach(4, dice.vector(0.8));
    Solver one = test::solver_for(chain), other = test::solver_for(chain);
    ASSERT_TRUE(one.solve({&goal, 1}, chain.pose).ok());
    goal.target = move * goal.target;
    ASSERT_TRUE(other.solve({&goal, 1}, moved.pose).ok());
    for (std::size_t j = 0; j < chain.pose.size(); ++j) {
      EXPECT_LT((move * chain.pose[j].position - moved.pose[j].position).norm(), 1e-6);
    }
  }
}

TEST(IkSolver, AGoalOutOfReachIsComeNearTo) {
  Chain chain = test::straight_chain(4);
  const Goal goal = test::reach(3, Vec3(3, 0, 0));
  Solver solver = test::solver_for(chain);
  const auto outcome = solver.solve({&goal, 1}, chain.pose);
  ASSERT_TRUE(outcome.ok());
  EXPECT_FALSE((*outcome)->reached);
  EXPECT_EQ((*outcome)->goals[0].held_by, -1);
  EXPECT_NEAR((*outcome)->goals[0].distance, 2.1, 2e-3);
}

// Frame by frame from the same start, as a motion is solved: a target that circles out of reach.
TEST(IkSolver, WhatIsOutOfReachIsFollowedSmoothly) {
  Dice dice(16);
  const Chain start = test::bent_chain(5, dice, 0.6);
  Solver solver = test::solver_for(start);
  constexpr double kStep = 0.01;
  Vec3 before = Vec3::Zero();
  for (int i = 0; i < 200; ++i) {
    const double angle = 0.3 + kStep * i;
    const Goal goal = test::reach(4, 2.5 * Vec3(std::sin(angle), std::cos(angle), 0.2));
    auto pose = start.pose;
    const auto outcome = solver.solve({&goal, 1}, pose);
    ASSERT_TRUE(outcome.ok());
    EXPECT_FALSE((*outcome)->reached);
    // The chain is 1.2 m long, so that its end goes 12 mm a step.
    if (i > 0) {
      EXPECT_LT((pose[4].position - before).norm(), 2 * 1.2 * kStep) << i;
    }
    EXPECT_GT(pose[4].position.norm(), 1.19) << i;
    before = pose[4].position;
  }
}

TEST(IkSolver, NamesTheJointWhoseLimitHoldsBack) {
  // Joint 2 may bend by 0.3 alone; the others of the chain freely, but they are kept straight.
  Chain chain = test::straight_chain(4);
  Limits limits(4);
  for (JointLimit& limit : limits) limit.kind = JointLimit::Kind::locked;
  limits[1].kind = limits[2].kind = JointLimit::Kind::hinge;
  for (const std::size_t j : {std::size_t{1}, std::size_t{2}}) {
    limits[j].axis = Vec3::UnitZ();
    limits[j].swing_axis = Vec3::UnitX();
  }
  limits[1].min_twist = -2, limits[1].max_twist = 2;
  limits[2].min_twist = 0, limits[2].max_twist = 0.3;
  // In reach only with joint 2 bent by a right angle.
  const Goal goal = test::reach(3, Vec3(-0.3, 0.6, 0));
  Solver solver = test::solver_for(chain, limits);
  const auto outcome = solver.solve({&goal, 1}, chain.pose);
  ASSERT_TRUE(outcome.ok());
  EXPECT_FALSE((*outcome)->reached);
  EXPECT_EQ((*outcome)->goals[0].held_by, 2);
  EXPECT_NEAR(measure(limits[2], test::local_of(chain, 2)).twist, 0.3, 1e-9);
}

TEST(IkSolver, StiffJointsTurnLess) {
  const auto turned = [](double stiffness) {
    Dice dice(15);
    Chain chain = test::bent_chain(5, dice, 1.0);
    const Chain start = chain;
    Options options;
    options.stiffness = {1, stiffness, 0, 0, 0};
    Solver solver = test::solver_for(chain, {}, options);
    const Goal goal = test::reach(4, chain.pose[4].position + Vec3(0.05, -0.08, 0.06));
    EXPECT_TRUE((*solver.solve({&goal, 1}, chain.pose))->reached);
    EXPECT_LT(angle_between(chain.pose[0].orientation, start.pose[0].orientation), 1e-12);
    return angle_between(test::local_of(chain, 1), test::local_of(start, 1));
  };
  EXPECT_GT(turned(0), 1.2 * turned(0.8));
  EXPECT_GT(turned(0.8), 1.2 * turned(0.95));
  EXPECT_GT(turned(0.95), 1e-4);
}

TEST(IkSolver, DepthLeavesTheJointsAboveAlone) {
  Chain chain = test::straight_chain(6);
  Goal goal = test::reach(5, Vec3(0.3, 1.3, 0.1));
  goal.depth = 3;
  const auto before = chain.pose;
  Solver solver = test::solver_for(chain);
  ASSERT_TRUE(solver.solve({&goal, 1}, chain.pose).ok());
  for (std::size_t j = 0; j <= 2; ++j) {
    EXPECT_EQ(angle_between(chain.pose[j].orientation, before[j].orientation), 0);
  }
  EXPECT_GT(angle_between(chain.pose[3].orientation, before[3].orientation), 0.05);
}

TEST(IkSolver, IterationsAndTolerancesEndIt) {
  const auto solve = [](int iterations, double distance) {
    Dice dice(11);
    Chain chain = test::bent_chain(6, dice);
    Options options;
    options.iterations = iterations;
    options.distance = distance;
    Solver solver = test::solver_for(chain, {}, options);
    const Goal goal = test::reach(5, Vec3(0.5, 0.4, 0.6));
    const Outcome outcome = **solver.solve({&goal, 1}, chain.pose);
    return std::pair(outcome.iterations, outcome.goals[0].distance);
  };
  EXPECT_EQ(solve(1, 1e-9).first, 1);
  EXPECT_GT(solve(1, 1e-9).second, 1e-6);
  EXPECT_LE(solve(60, 1e-9).second, 1e-9);
  EXPECT_LT(solve(60, 0.05).first, solve(60, 1e-9).first);
  EXPECT_GT(solve(60, 0.05).second, 1e-9);
}

TEST(IkSolver, FurtherStartsFindWhatTheFirstMisses) {
  Dice dice(12);
  int alone = 0, helped = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Chain chain = test::straight_chain(5);
    Limits limits;
    std::vector<Transform> local(5), wanted(5);
    world_to_local(chain.parents, chain.pose, local);
    for (int j = 0; j < 5; ++j) {
      limits.push_back(dice.hinge());
      local[at(j)].orientation = clamped(limits.back(), dice.rotation());
    }
    local_to_world(chain.parents, local, wanted);
    const Goal goal = test::reach(4, wanted[4].position);
    for (const int restarts : {0, 40}) {
      Options options;
      options.restarts = restarts;
      Solver solver = test::solver_for(chain, limits, options);
      auto pose = chain.pose;
      const Outcome outcome = **solver.solve({&goal, 1}, pose);
      (restarts == 0 ? alone : helped) += outcome.reached ? 1 : 0;
      if (restarts == 0) {
        EXPECT_EQ(outcome.starts, 1);
      }
    }
  }
  EXPECT_GT(helped, alone + 10);
  EXPECT_GE(helped, 195);
}

TEST(IkSolver, WhatGoalsLeaveOpenIsDrawnToTheStartPose) {
  const auto distance_from_start = [](double pull) {
    Dice dice(13);
    double sum = 0;
    for (int trial = 0; trial < 20; ++trial) {
      Chain chain = test::bent_chain(8, dice);
      const Chain start = chain;
      Options options;
      options.rest_pull = pull;
      options.distance = 1e-7;
      Solver solver = test::solver_for(chain, {}, options);
      const Goal goal = test::reach(7, Vec3(0.9, 0.8, 0.4));
      EXPECT_TRUE((*solver.solve({&goal, 1}, chain.pose))->reached);
      for (int j = 0; j < 8; ++j) {
        const double angle = angle_between(test::local_of(chain, j), test::local_of(start, j));
        sum += angle * angle;
      }
    }
    return sum;
  };
  EXPECT_LT(distance_from_start(0.5), 0.99 * distance_from_start(0));
}

TEST(IkSolver, TheSameOnEveryRunAndWhateverWasSolvedBefore) {
  Dice dice(14);
  Chain chain = test::bent_chain(6, dice);
  Options options;
  options.restarts = 5;
  Limits limits;
  for (int j = 0; j < 6; ++j) limits.push_back(dice.cone());
  const Goal goal = test::reach(5, dice.vector(2)), other = test::reach(3, dice.vector());
  Solver fresh = test::solver_for(chain, limits, options);
  Solver used = test::solver_for(chain, limits, options);
  auto first = chain.pose, second = chain.pose, scratch = chain.pose;
  ASSERT_TRUE(used.solve({&other, 1}, scratch).ok());
  ASSERT_TRUE(fresh.solve({&goal, 1}, first).ok());
  ASSERT_TRUE(used.solve({&goal, 1}, second).ok());
  for (std::size_t j = 0; j < first.size(); ++j) {
    EXPECT_EQ(first[j].position, second[j].position);
    EXPECT_EQ(first[j].orientation.coeffs(), second[j].orientation.coeffs());
  }
}

TEST(IkSolver, ARootThatMayMoveTakesTheBodyAlong) {
  Chain chain = test::straight_chain(3);
  Options options;
  options.root_moves = true;
  Solver solver = test::solver_for(chain, {}, options);
  const Goal goal = test::reach(2, Vec3(5, 0, 0));
  EXPECT_TRUE((*solver.solve({&goal, 1}, chain.pose))->reached);
  EXPECT_GT(chain.pose[0].position.norm(), 3);
}

// Would fail if the ground bone of a rig left the ground with the pelvis, or if the shift of a
// joint in a turned parent's frame went another way.
TEST(IkSolver, AJointBelowTheRootMayMoveAlone) {
  Dice dice(15);
  Chain chain = test::bent_chain(4, dice);
  Options options;
  options.root_moves = true;
  options.moving_joint = 1;
  options.stiffness = {1, 0, 0, 0};
  Solver solver = test::solver_for(chain, {}, options);
  const Transform root = chain.pose[0];
  const Vec3 place = chain.pose[1].position;
  const Goal goal = test::reach(3, Vec3(9, 1, -3));
  EXPECT_TRUE((*solver.solve({&goal, 1}, chain.pose))->reached);
  EXPECT_LT((chain.pose[0].position - root.position).norm(), 1e-12);
  EXPECT_LT(angle_between(chain.pose[0].orientation, root.orientation), 1e-9);
  EXPECT_GT((chain.pose[1].position - place).norm(), 3);
}

TEST(IkSolver, WrongGoalsAndOptionsAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Chain chain = test::straight_chain(3);
  const auto before = chain.pose;
  Solver solver = test::solver_for(chain);
  std::vector<Goal> bad(8, test::reach(2, Vec3::Zero()));
  bad[0].joint = 3;
  bad[1].joint = -1;
  bad[2].target.x() = nan;
  bad[3].weight = 0;
  bad[4].depth = -1;
  bad[5].orientation = Quat(0, 0, 0, 0);
  bad[6].kind = Goal::Kind::pole;  // the last joint bends nothing
  bad[7].kind = Goal::Kind::pole, bad[7].joint = 1, bad[7].lower = 7;
  for (const Goal& goal : bad) {
    const auto outcome = solver.solve({&goal, 1}, chain.pose);
    ASSERT_FALSE(outcome.ok());
    EXPECT_EQ(outcome.error().code, "ik-goal");
    for (std::size_t j = 0; j < before.size(); ++j) {
      EXPECT_EQ(chain.pose[j].position, before[j].position);
    }
  }
  std::vector<Options> wrong(6);
  wrong[0].stiffness = {0.5};
  wrong[1].stiffness = {0, 2, 0};
  wrong[2].rest_pull = nan;
  wrong[3].iterations = -1;
  wrong[4].masses = {1, nan, 1};
  wrong[5].root_moves = true, wrong[5].moving_joint = 3;
  for (const Options& options : wrong) {
    const auto made = Solver::create(chain.parents, {}, options);
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().code, "ik-option");
  }
  EXPECT_TRUE((*solver.solve({}, chain.pose))->reached);
}

// More goals than joints can follow: the equations are then over joints, which is a hundred times
// as quick for a body with a goal on each joint. Both kinds of equations must give the same pose.
TEST(IkSolver, ManyGoalsGiveWhatFewGoalsOfTheSameMeaningGive) {
  Dice dice(8);
  constexpr int kJoints = 8;
  for (int trial = 0; trial < 20; ++trial) {
    const Chain chain = test::bent_chain(kJoints, dice, 1.2);
    std::vector<Goal> few;
    for (int j = 3; j < kJoints; ++j) {
      Goal goal;
      goal.kind = Goal::Kind::position;
      goal.joint = j;
      goal.target = chain.pose[at(j)].position + dice.vector(0.1);
      goal.weight = 0.5 + 0.1 * j;
      few.push_back(goal);
    }
    // Each goal 16 times with a quarter of its weight: the same sum of squares.
    std::vector<Goal> many;
    for (Goal goal : few) {
      goal.weight /= 4;
      for (int i = 0; i < 16; ++i) many.push_back(goal);
    }
    Options options;
    options.iterations = 8;
    std::vector<std::vector<Transform>> poses;
    for (const auto& goals : {few, many}) {
      auto solver = Solver::create(chain.parents, {}, options);
      ASSERT_TRUE(solver);
      poses.push_back(chain.pose);
      ASSERT_TRUE(solver->solve(goals, poses.back()));
    }
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_LT((poses[0][at(j)].position - poses[1][at(j)].position).norm(), 1e-5)
          << "trial " << trial << ", joint " << j;
    }
  }
}

}  // namespace
}  // namespace krok::ik
