// If these fail, goals in a motion take hold with a jump, change frames that they have no part in,
// follow the wrong joint, or come out differently on another number of threads.

#include "ik/goal_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "ik/limits.h"
#include "math/quaternion.h"
#include "roles/roles.h"
#include "support/test_scenes.h"

namespace krok::ik {
namespace {

Clip calm_human(int frames) {
  Clip clip = krok::test::swinging_clip(krok::test::turned_human(), frames, 60);
  return clip;
}

KeyedGoal reach_of(const Clip& clip, const char* joint, double time, const Vec3& target) {
  KeyedGoal goal;
  goal.name = joint;
  goal.goal.joint = clip.skeleton.find(joint);
  goal.goal.depth = 5;
  goal.keys = {{time, target, Quat::Identity(), {}}};
  return goal;
}

Vec3 place(const Clip& clip, int frame, const char* joint) {
  return clip.frame_positions(frame)[at(clip.skeleton.find(joint))].cast<double>();
}

bool same_frame(const Clip& a, const Clip& b, int frame) {
  const auto pa = a.frame_positions(frame), pb = b.frame_positions(frame);
  const auto qa = a.frame_orientations(frame), qb = b.frame_orientations(frame);
  for (std::size_t j = 0; j < pa.size(); ++j) {
    if (pa[j] != pb[j] || qa[j].coeffs() != qb[j].coeffs()) return false;
  }
  return true;
}

TEST(GoalMotion, ReachesAtItsTimeAndLeavesOtherFramesBitForBit) {
  const Clip clip = calm_human(120);
  const Vec3 target = place(clip, 60, "LeftHand") + Vec3(-0.1, 0.1, 0.05);
  const KeyedGoal goal = reach_of(clip, "LeftHand", 1.0, target);
  const auto made = apply_goals(clip, {&goal, 1}, {});
  ASSERT_TRUE(made.ok());
  EXPECT_LT((place(made->clip, 60, "LeftHand") - target).norm(), 2e-4);
  int changed = 0;
  for (int f = 0; f < 120; ++f) {
    const bool inside = std::abs(f / 60.0 - 1) < 0.3 - 1e-9;
    EXPECT_EQ(same_frame(clip, made->clip, f), !inside) << f;
    changed += inside ? 1 : 0;
  }
  EXPECT_EQ(made->changed_frames, changed);
  EXPECT_EQ(made->goals[0].size(), at(changed));
}

// Acceleration of a hand that fades into a hold and out of it stays of the size of the way over the
// time squared; a jump of a millimetre in a frame would be 3.6 m/s^2 alone.
TEST(GoalMotion, TakesHoldAndLetsGoWithoutAJump) {
  Clip clip = calm_human(180);
  for (int f = 1; f < 180; ++f) {
    std::vector<Transform> pose(clip.skeleton.names.size());
    clip.get_pose(0, pose);
    clip.set_pose(f, pose);
  }
  KeyedGoal goal = reach_of(clip, "RightHand", 1.5, place(clip, 0, "RightHand") + Vec3(0, 0.1, 0));
  goal.fade_in = goal.fade_out = 0.5;
  // Limits that the pose itself breaks must not make it jump either.
  const RoleMap roles = find_roles(clip.skeleton);
  for (const bool limited : {false, true}) {
    const Limits limits = limited ? anatomical_limits(clip.skeleton, roles) : Limits();
    const auto made = apply_goals(clip, {&goal, 1}, limits);
    ASSERT_TRUE(made.ok());
    for (int f = 1; f + 1 < 180; ++f) {
      for (const char* joint : {"RightHand", "RightForeArm"}) {
        const Vec3 second = place(made->clip, f + 1, joint) - 2 * place(made->clip, f, joint) +
                            place(made->clip, f - 1, joint);
        EXPECT_LT(second.norm() * 3600, limited ? 30 : 5) << f << " " << joint;
      }
    }
  }
}

TEST(GoalMotion, MovesThroughItsKeysWithTheirEasing) {
  const Clip clip = calm_human(61);
  KeyedGoal goal = reach_of(clip, "LeftHand", 0.0, Vec3::Zero());
  goal.keys = {{0.0, Vec3(0, 0, 0), Quat::Identity(), {timeline::Curve::linear, {}}},
               {1.0, Vec3(1, 0, 0), Quat::Identity(), {timeline::Curve::smooth, {}}},
               {2.0, Vec3(1, 1, 0), Quat::Identity(), {}}};
  EXPECT_NEAR(key_at(goal, 0.25).target.x(), 0.25, 1e-12);
  EXPECT_NEAR(key_at(goal, 1.25).target.y(), 3 * 0.0625 - 2 * 0.015625, 1e-12);
  EXPECT_EQ(key_at(goal, -1).target, Vec3(0, 0, 0));
  EXPECT_EQ(key_at(goal, 9).target, Vec3(1, 1, 0));
  EXPECT_EQ(strength_at(goal, 1, 3, 30), 1);
  EXPECT_EQ(strength_at(goal, 2.31, 3, 30), 0);
  EXPECT_NEAR(strength_at(goal, 2.15, 3, 30), 0.5, 1e-9);
}

// Would fail if a goal for a time between two frames were at full strength in none of them: it
// would be called reached ten metres away, as one that only fades.
TEST(GoalMotion, AGoalBetweenTwoFramesIsOfTheNearerOne) {
  const Clip clip = calm_human(61);
  const KeyedGoal goal = reach_of(clip, "LeftHand", 0.5 + 0.4 / clip.rate, Vec3::Zero());
  const auto strength = [&](int frame) {
    return strength_at(goal, frame / clip.rate, clip.duration(), clip.rate);
  };
  const int nearer = static_cast<int>(std::lround(0.5 * clip.rate));
  EXPECT_EQ(strength(nearer), 1);
  EXPECT_LT(strength(nearer - 1), 1);
  EXPECT_LT(strength(nearer + 1), 1);
  KeyedGoal late = goal;
  late.keys.front().time = clip.duration() + 5;
  EXPECT_EQ(strength_at(late, clip.duration(), clip.duration(), clip.rate), 0);
}

TEST(GoalMotion, FollowsAJointThatMovesWithTheSolution) {
  const Clip clip = calm_human(60);
  // The right hand on the left one, while the left one reaches for a place.
  std::vector<KeyedGoal> goals = {
      reach_of(clip, "LeftHand", 0.5, place(clip, 30, "Spine2") + Vec3(0.1, -0.05, 0.3)),
      reach_of(clip, "RightHand", 0.5, Vec3(0, 0.02, 0))};
  goals[1].relative_to = clip.skeleton.find("LeftHand");
  const auto made = apply_goals(clip, goals, {});
  ASSERT_TRUE(made.ok());
  std::vector<Transform> pose(clip.skeleton.names.size());
  made->clip.get_pose(30, pose);
  const Vec3 wanted = pose[at(goals[1].relative_to)] * Vec3(0, 0.02, 0);
  EXPECT_LT((place(made->clip, 30, "LeftHand") - goals[0].keys[0].target).norm(), 5e-4);
  EXPECT_LT((place(made->clip, 30, "RightHand") - wanted).norm(), 1e-3);
}

// Goals that move each other: each hand seeks the other one, which the trunk carries, too, and the
// head looks at one of them. What is reported is what is in the motion, whether reached or not.
TEST(GoalMotion, ReportsWhatIsInTheMotionWhereGoalsMoveEachOther) {
  const Clip clip = calm_human(20);
  const auto joint = [&](const char* name) { return clip.skeleton.find(name); };
  std::vector<KeyedGoal> goals = {reach_of(clip, "LeftHand", 0.0, Vec3(0, 0.05, 0)),
                                  reach_of(clip, "RightHand", 0.0, Vec3(0, 0.05, 0)),
                                  reach_of(clip, "Head", 0.0, Vec3::Zero()),
                                  reach_of(clip, "LeftHand", 0.0, Vec3::Zero())};
  goals[0].relative_to = joint("RightHand");
  goals[1].relative_to = joint("LeftHand");
  goals[1].goal.kind = Goal::Kind::pose;
  goals[2].relative_to = joint("RightHand");
  goals[2].goal.kind = Goal::Kind::look_at;
  goals[3].goal.kind = Goal::Kind::orientation;
  goals[3].relative_to = joint("Spine1");
  for (KeyedGoal& goal : goals) goal.to = 1.0;
  for (const Method method : {Method::least_squares, Method::ccd, Method::two_bone}) {
    GoalMotionOptions options;
    options.solver.method = method;
    for (std::size_t first = 0; first < goals.size(); ++first) {
      const std::span<const KeyedGoal> some(goals.data() + first,
                                            std::min<std::size_t>(2, 4 - first));
      const auto made = apply_goals(clip, some, {}, options);
      ASSERT_TRUE(made.ok());
      for (std::size_t g = 0; g < some.size(); ++g) {
        for (const GoalFrame& frame : made->goals[g]) {
          std::vector<Transform> pose(clip.skeleton.names.size());
          made->clip.get_pose(frame.frame, pose);
          const Goal sought = goal_in_frame(some[g], made->clip, frame.frame);
          const Residual seen =
              residuals({&sought, 1}, clip.skeleton.parents, pose, options.solver)[0];
          EXPECT_NEAR(seen.distance, frame.residual.distance, 2e-6) << first << " " << g;
          EXPECT_NEAR(seen.angle, frame.residual.angle, 2e-5) << first << " " << g;
        }
      }
    }
  }
}

// The derivatives by the joints that move an anchor: a hand seeks the other one, which hangs on the
// same trunk, to a thousandth of a millimetre.
TEST(GoalMotion, ReachesAJointThatTheTrunkMoves) {
  const Clip clip = calm_human(60);
  KeyedGoal goal = reach_of(clip, "LeftHand", 0.0, Vec3::Zero());
  goal.relative_to = clip.skeleton.find("RightForeArm");
  goal.to = 2.0;
  GoalMotionOptions options;
  options.solver.distance = 1e-6;
  const auto made = apply_goals(clip, {&goal, 1}, {}, options);
  ASSERT_TRUE(made.ok());
  for (int f = 0; f < 60; ++f) {
    EXPECT_LT((place(made->clip, f, "LeftHand") - place(made->clip, f, "RightForeArm")).norm(),
              3e-6);
  }
}

TEST(GoalMotion, FollowsAJointOfAnotherMotion) {
  const Clip clip = calm_human(60);
  Clip other = krok::test::swinging_human(30);  // 30 Hz: sampled between its frames
  for (Vec3f& position : other.positions) position += Vec3f(-0.05f, 0.03f, 0.05f);
  KeyedGoal goal = reach_of(clip, "LeftHand", 0.5, Vec3(0, 0, 0));
  goal.motion = &other;
  goal.relative_to = other.skeleton.find("LeftHand");
  const auto made = apply_goals(clip, {&goal, 1}, {});
  ASSERT_TRUE(made.ok());
  EXPECT_LT((place(made->clip, 30, "LeftHand") - place(other, 15, "LeftHand")).norm(), 5e-4);
}

TEST(GoalMotion, KeepsLimitsAtFullStrengthAndReportsWhatItMisses) {
  const Clip clip = calm_human(90);
  const Clip* one = &clip;
  const auto limits = learn_limits(clip.skeleton, {&one, 1});
  ASSERT_TRUE(limits.ok());
  KeyedGoal goal = reach_of(clip, "RightHand", 0.5, place(clip, 30, "RightHand") + Vec3(2, 0, 0));
  goal.to = 1.0;
  const auto made = apply_goals(clip, {&goal, 1}, *limits);
  ASSERT_TRUE(made.ok());
  EXPECT_LE(made->largest_excess, 1e-6);
  bool missed = false;
  for (const GoalFrame& frame : made->goals[0]) {
    if (frame.strength < 1) continue;
    missed = true;
    EXPECT_FALSE(frame.residual.reached);
    EXPECT_GT(frame.residual.distance, 0.5);
  }
  EXPECT_TRUE(missed);
}

TEST(GoalMotion, TheSameForAnyNumberOfThreads) {
  const Clip clip = calm_human(200);
  const KeyedGoal goal = [&] {
    KeyedGoal made = reach_of(clip, "LeftFoot", 0.5, place(clip, 30, "LeftFoot"));
    made.to = 3;
    return made;
  }();
  GoalMotionOptions options;
  options.jobs = 1;
  const auto one = apply_goals(clip, {&goal, 1}, {}, options);
  options.jobs = 4;
  const auto four = apply_goals(clip, {&goal, 1}, {}, options);
  ASSERT_TRUE(one.ok() && four.ok());
  for (int f = 0; f < 200; ++f) EXPECT_TRUE(same_frame(one->clip, four->clip, f)) << f;
}

// Where blocks meet, within fades and holds, a motion would jump, and facts would be of a block.
TEST(GoalMotion, TheSameInBlocksOfAnySize) {
  const Clip clip = calm_human(200);
  std::vector<KeyedGoal> goals = {
      reach_of(clip, "LeftHand", 0.5, place(clip, 30, "LeftHand") + Vec3(2, 0.1, 0)),
      reach_of(clip, "RightHand", 1.5, Vec3(0, 0.02, 0)),
      reach_of(clip, "LeftFoot", 3.1, place(clip, 30, "LeftFoot"))};
  goals[0].to = 1.4;
  goals[1].relative_to = clip.skeleton.find("LeftHand");
  const GoalMotion whole = apply_goals(clip, goals, {}).value();
  EXPECT_FALSE(same_frame(clip, whole.clip, 60));
  for (const int size : {1, 7, 64}) {
    const GoalFrames blocks = apply_goals(frames_of(clip), goals, {}, {}, size).value();
    for (int pass = 0; pass < 2; ++pass) {
      const Clip made = load(blocks.frames, 3).value();
      EXPECT_TRUE(made.positions == whole.clip.positions) << size;
      EXPECT_TRUE(made.orientations == whole.clip.orientations) << size;
      const GoalMotion& facts = *blocks.motion;
      EXPECT_EQ(facts.changed_frames, whole.changed_frames);
      EXPECT_EQ(facts.largest_turn, whole.largest_turn);
      EXPECT_EQ(facts.input_turn, whole.input_turn);
      EXPECT_EQ(facts.turning_joint, whole.turning_joint);
      EXPECT_EQ(facts.turning_frame, whole.turning_frame);
      for (std::size_t g = 0; g < goals.size(); ++g) {
        EXPECT_TRUE(std::ranges::equal(facts.goals[g], whole.goals[g], [](auto& a, auto& b) {
          return a.frame == b.frame && a.residual.distance == b.residual.distance;
        }));
      }
    }
  }
}

// A hand that follows a circle about its shoulder, near or out of reach, does not flip or spin: no
// joint turns much more in a frame than the goal does.
TEST(GoalMotion, NothingFlipsAlongAMovingGoal) {
  const Clip clip = calm_human(180);
  const Vec3 shoulder = place(clip, 0, "LeftArm");
  const double arm = (place(clip, 0, "LeftForeArm") - shoulder).norm() +
                     (place(clip, 0, "LeftHand") - place(clip, 0, "LeftForeArm")).norm();
  for (const Method method : {Method::least_squares, Method::ccd, Method::two_bone}) {
    for (const double lengths : {0.7, 1.5}) {
      KeyedGoal goal = reach_of(clip, "LeftHand", 0, Vec3::Zero());
      goal.goal.depth = 3;
      goal.keys.clear();
      for (int i = 0; i <= 12; ++i) {
        const double angle = 2 * kPi * i / 12;
        goal.keys.push_back({0.25 * i,
                             shoulder + lengths * arm * Vec3(0.3, std::sin(angle), std::cos(angle)),
                             Quat::Identity(),
                             {}});
      }
      GoalMotionOptions options;
      options.solver.method = method;
      const auto made = apply_goals(clip, {&goal, 1}, {}, options);
      ASSERT_TRUE(made.ok());
      EXPECT_LT(made->largest_turn, 35 * kRadiansPerDegree)
          << static_cast<int>(method) << " " << lengths << " frame " << made->turning_frame;
    }
  }
}

// While a goal out of reach fades in, each joint turns as evenly as the fade runs: never in a frame
// by more than the steepest part of it, 15/8 of the mean, and some room. On the straight way to
// such a place the elbow would snap.
// Who walked by a place that was near leaned towards it while it was still far.
TEST(GoalMotion, WhoWalksByLeansTowardsNothingFar) {
  Clip clip = calm_human(121);
  for (int f = 0; f < 121; ++f) {
    std::vector<Transform> pose(clip.skeleton.names.size());
    clip.get_pose(f, pose);
    for (Transform& joint : pose) joint.position.z() += 2.0 * f / 60;
    clip.set_pose(f, pose);
  }
  const Vec3 shoulder = place(clip, 60, "LeftArm");
  const double arm = (place(clip, 60, "LeftForeArm") - shoulder).norm() +
                     (place(clip, 60, "LeftHand") - place(clip, 60, "LeftForeArm")).norm();
  KeyedGoal goal = reach_of(clip, "LeftHand", 1.0, shoulder + 0.6 * arm * Vec3::UnitZ());
  goal.fade_in = goal.fade_out = 0.5;
  GoalMotionOptions options;
  options.solver.stiffness = trunk_stiffness(clip.skeleton, find_roles(clip.skeleton), 0.5);
  const auto made = apply_goals(clip, {&goal, 1}, {}, options);
  ASSERT_TRUE(made.ok());
  EXPECT_LT((place(made->clip, 60, "LeftHand") - goal.keys[0].target).norm(), 1e-4);
  const auto chest = at(clip.skeleton.parents[at(clip.skeleton.find("LeftShoulder"))]);
  double largest = 0;
  for (int f = 0; f < 121; ++f) {
    largest =
        std::max(largest, angle_between(clip.frame_orientations(f)[chest].cast<double>(),
                                        made->clip.frame_orientations(f)[chest].cast<double>()));
  }
  EXPECT_LT(largest, 5 * kRadiansPerDegree);  // 46 before
}

TEST(GoalMotion, AnArmStraightensAsEvenlyAsTheFadeRuns) {
  Clip clip = calm_human(90);
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(0, pose);
  // An elbow bent by 100 degrees.
  const int elbow = clip.skeleton.find("LeftForeArm");
  const Vec3 pivot = pose[at(elbow)].position;
  const Quat bend = from_rotation_vector(100 * kRadiansPerDegree * Vec3::UnitX());
  for (int j = elbow; j < clip.skeleton.joint_count(); ++j) {
    int above = j;
    while (above > elbow) above = clip.skeleton.parents[at(above)];
    if (above != elbow) continue;
    pose[at(j)].position = pivot + bend * (pose[at(j)].position - pivot);
    pose[at(j)].orientation = bend * pose[at(j)].orientation;
  }
  for (int f = 0; f < 90; ++f) clip.set_pose(f, pose);
  const auto local = [&](const Clip& of, int f, std::size_t j) -> Quat {
    const auto turns = of.frame_orientations(f);
    const auto parent = at(clip.skeleton.parents[j]);
    return turns[parent].cast<double>().conjugate() * turns[j].cast<double>();
  };
  for (const Method method :
       {Method::least_squares, Method::selectively_damped, Method::ccd, Method::two_bone}) {
    for (const double time : {1.0, 0.2}) {  // 0.2: the motion begins as the goal already fades in
      KeyedGoal goal = reach_of(clip, "LeftHand", time, place(clip, 0, "LeftArm") + Vec3(2, 1, 2));
      goal.goal.depth = 3;
      GoalMotionOptions options;
      options.solver.method = method;
      const auto made = apply_goals(clip, {&goal, 1}, {}, options);
      ASSERT_TRUE(made.ok());
      const int full = static_cast<int>(std::lround(time * 60));
      for (std::size_t j = 1; j < pose.size(); ++j) {
        const double whole = angle_between(local(clip, full, j), local(made->clip, full, j));
        const double steepest = 15.0 / 8 * whole / (0.3 * 60);
        for (int f = 1; f <= full; ++f) {
          EXPECT_LT(angle_between(local(made->clip, f - 1, j), local(made->clip, f, j)),
                    1.2 * steepest + 0.5 * kRadiansPerDegree)
              << static_cast<int>(method) << " " << clip.skeleton.names[j] << " frame " << f;
        }
      }
    }
  }
}

TEST(GoalMotion, WrongKeysAreRefused) {
  const Clip clip = calm_human(30);
  std::vector<KeyedGoal> bad(6, reach_of(clip, "LeftHand", 0.5, Vec3(0, 1, 0)));
  bad[0].keys.clear();
  bad[1].keys.push_back(bad[1].keys[0]);
  bad[2].fade_in = -1;
  bad[3].goal.joint = 999;
  bad[4].relative_to = 999;
  bad[5].support_joints = {999};
  for (const KeyedGoal& goal : bad) {
    const auto made = apply_goals(clip, {&goal, 1}, {});
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().code, "ik-goal");
  }
}

// What viewers draw: otherwise markers are elsewhere than where the solver brought the joints.
TEST(GoalMotion, AGoalOfAFrameIsWhereTheSolverSoughtIt) {
  const Clip clip = calm_human(120);
  Clip other = clip;
  for (Vec3f& position : other.positions) position += Vec3f(0, 0.04f, 0.02f);
  std::vector<KeyedGoal> goals(3, reach_of(clip, "LeftHand", 0.5, Vec3::Zero()));
  goals[0].keys = {{0.5, place(clip, 30, "LeftHand"), Quat::Identity(), {}},
                   {1.5, place(clip, 90, "LeftHand"), Quat::Identity(), {}}};
  goals[1].motion = &other;
  goals[1].relative_to = clip.skeleton.find("LeftHand");
  goals[2].relative_to = clip.skeleton.find("Head");
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(30, pose);
  goals[2].keys[0].target = pose[at(goals[2].relative_to)].inverse() *
                            Vec3(place(clip, 30, "LeftHand") + Vec3(-0.05, 0.04, 0.02));
  for (KeyedGoal& goal : goals) {
    goal.to = 1.5;
    const auto made = apply_goals(clip, {&goal, 1}, {});
    ASSERT_TRUE(made.ok());
    for (const int f : {30, 47, 60, 90}) {
      if (f > 30 && &goal == &goals[2]) break;  // the head moves on, out of the hand's reach
      const Vec3 sought = goal_in_frame(goal, made->clip, f).target;
      EXPECT_LT((place(made->clip, f, "LeftHand") - sought).norm(), 2e-4) << f;
    }
  }
  // The support is where its joints stand in that frame.
  KeyedGoal balance;
  balance.goal.kind = Goal::Kind::balance;
  balance.support_joints = {clip.skeleton.find("LeftHand")};
  const auto support = goal_in_frame(balance, clip, 30).support;
  ASSERT_EQ(support.size(), 1u);
  EXPECT_NEAR(support[0].x(), place(clip, 30, "LeftHand").x(), 1e-9);
}

TEST(GoalMotion, TheOutlineIsConvexAndHoldsAllPoints) {
  const auto hull = outline({{0, 0}, {1, 0}, {0.5, 0.2}, {1, 1}, {0, 1}, {0.5, 0}, {1, 0}});
  EXPECT_EQ(hull.size(), 4u);
  EXPECT_EQ(outline({{1, 2}, {1, 2}}).size(), 1u);
  EXPECT_EQ(outline({{0, 0}, {1, 1}, {2, 2}}).size(), 2u);
}

}  // namespace
}  // namespace krok::ik
