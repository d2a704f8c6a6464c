// If these fail, a walker does not follow his motion, does not come back to it after a push, sinks
// in, or follows another way when the same body is described in another way.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "math/quaternion.h"
#include "ragdoll/simulate.h"
#include "samples/generator/walk.h"

namespace krok::ragdoll::play_on_test {
namespace {

class PlayOn : public testing::Test {
 protected:
  PlayOn() {
    samples::WalkOptions options;
    options.steps = 8;
    options.rate = 60;
    walk_ = samples::make_walk(options)->clip;
  }

  // All bodies powered, the root held; a strength of 1: animated.
  static void power(std::vector<Body>& bodies, double strength, double hold) {
    for (Body& body : bodies) {
      body.mode = BodyMode::powered;
      body.strength = strength;
    }
    bodies.front().mode = hold < 1 ? BodyMode::powered : BodyMode::animated;
    bodies.front().strength = hold;
  }

  // Only what is below the joint is simulated.
  static void let_go(std::vector<Body>& bodies, const Skeleton& skeleton,
                     const std::string& joint) {
    const int top = skeleton.find(joint);
    for (Body& body : bodies) {
      body.mode = BodyMode::animated;
      for (int j = body.joint; j >= 0; j = skeleton.parents[at(j)]) {
        if (j == top) body.mode = BodyMode::simulated;
      }
    }
  }

  template <typename SetModes>
  static Fall play(const Clip& motion, const std::vector<Push>& pushes, double duration,
                   const SetModes& set_modes, bool ground = true) {
    const RoleMap roles = find_roles(motion.skeleton);
    auto bodies = *make_bodies(motion.skeleton, roles);
    set_modes(bodies);
    FallOptions options;
    options.at = 0.2;
    options.duration = duration;
    options.surroundings.level = ground;
    options.pushes = pushes;
    auto fall = simulate_fall(motion, roles, bodies, ik::anatomical_limits(motion.skeleton, roles),
                              options);
    EXPECT_TRUE(fall.ok()) << fall.error().message;
    return std::move(*fall);
  }

  Fall shoved(const Clip& motion, const Vec3& impulse, bool ground = true) const {
    const RoleMap roles = find_roles(motion.skeleton);
    const auto bodies = *make_bodies(motion.skeleton, roles);
    int chest = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies[b].name == "chest") chest = static_cast<int>(b);
    }
    return play(
        motion, {{chest, impulse, 1.0}}, 3, [](std::vector<Body>& made) { power(made, 0.6, 0.5); },
        ground);
  }

  static Vec3 place(const Clip& clip, const std::string& joint, int frame) {
    return clip.frame_positions(frame)[at(clip.skeleton.find(joint))].cast<double>();
  }

  // Metres between the joints of two clips after `turn` of the first, the largest of all frames.
  static double farthest(const Clip& a, const Clip& b, const Transform& turn) {
    double most = 0;
    EXPECT_EQ(a.frame_count(), b.frame_count());
    for (int frame = 0; frame < a.frame_count(); ++frame) {
      for (int j = 0; j < a.joint_count(); ++j) {
        const std::string& name = a.skeleton.names[at(j)];
        most = std::max(most, (turn * place(a, name, frame) - place(b, name, frame)).norm());
      }
    }
    return most;
  }

  Clip walk_;
};

// With an adult's strength all bodies are within 5 degrees RMS of the motion (measured: 0.7).
TEST_F(PlayOn, FullStrengthFollowsTheMotion) {
  const Fall held = play(walk_, {}, 3.5, [](std::vector<Body>& bodies) { power(bodies, 1, 1); });
  EXPECT_LT(held.mean_off, 1.5 * kRadiansPerDegree);
  EXPECT_LT(held.largest_off, 10 * kRadiansPerDegree);
  const Fall on_his_feet =
      play(walk_, {}, 3.5, [](std::vector<Body>& bodies) { power(bodies, 1, 0.5); });
  EXPECT_LT(on_his_feet.mean_off, 5 * kRadiansPerDegree);
  EXPECT_LT(on_his_feet.settling.penetration, 0.005);
  EXPECT_LT(on_his_feet.largest.penetration, 0.005);
  EXPECT_LT(on_his_feet.largest.joint_gap, 1e-6);
  EXPECT_EQ(on_his_feet.rest, -1);
}

// Less strength follows less well, and none falls.
TEST_F(PlayOn, StrengthOrdersHowWellItFollows) {
  double before = 0;
  for (const double strength : {1.0, 0.4, 0.15}) {
    const Fall fall =
        play(walk_, {}, 2, [&](std::vector<Body>& bodies) { power(bodies, strength, 1); });
    EXPECT_GT(fall.mean_off, before) << strength;
    before = fall.mean_off;
  }
  const Fall limp = play(walk_, {}, 3, [](std::vector<Body>& bodies) { power(bodies, 0, 0); });
  const int last = limp.clip.frame_count() - 1;
  EXPECT_LT(place(limp.clip, "Hips", last).y(), 0.4);
}

// 75 Ns at the chest push it over 5 cm to the side; two seconds later it is back where it would be
// without the push, within 2 cm, and nothing has sunk into the ground.
TEST_F(PlayOn, AShovedWalkerStaggersAndGoesOn) {
  const Fall calm = shoved(walk_, Vec3::Zero());
  for (const Vec3& push : {Vec3(75, 0, 0), Vec3(-60, 0, 45)}) {
    const Fall fall = shoved(walk_, push);
    double most = 0;
    for (int frame = 60; frame < 120; ++frame) {
      const Vec3 off = place(fall.clip, "Spine2", frame) - place(calm.clip, "Spine2", frame);
      most = std::max(most, off.dot(push.normalized()));
    }
    EXPECT_GT(most, 0.05);
    EXPECT_LT(most, 0.5);
    EXPECT_LT((place(fall.clip, "Spine2", 180) - place(calm.clip, "Spine2", 180)).norm(), 0.02);
    EXPECT_LT((place(fall.clip, "Spine2", 180) - place(walk_, "Spine2", 180)).norm(), 0.1);
    EXPECT_LT(fall.largest.penetration, 0.005);
  }
}

// One arm hangs; all other joints are the motion's, bit for bit. The limp hand is lower than where
// the walk swings it to.
TEST_F(PlayOn, ALimpArmHangsOnAWalker) {
  const Fall fall = play(
      walk_, {}, 3, [&](std::vector<Body>& bodies) { let_go(bodies, walk_.skeleton, "LeftArm"); });
  double swing = 0, walked = 0;
  for (int frame = 60; frame < fall.clip.frame_count(); ++frame) {
    for (const char* joint : {"Hips", "Head", "RightHand", "LeftFoot", "LeftShoulder"}) {
      const int j = walk_.skeleton.find(joint);
      ASSERT_EQ(fall.clip.frame_positions(frame)[at(j)], walk_.frame_positions(frame)[at(j)]);
      ASSERT_EQ(fall.clip.frame_orientations(frame)[at(j)].coeffs(),
                walk_.frame_orientations(frame)[at(j)].coeffs());
    }
    ASSERT_LT((place(fall.clip, "LeftArm", frame) - place(walk_, "LeftArm", frame)).norm(), 1e-4);
    const auto ahead = [&](const Clip& clip) {
      return std::abs(place(clip, "LeftHand", frame).z() - place(clip, "LeftArm", frame).z());
    };
    swing = std::max(swing, ahead(fall.clip));
    walked = std::max(walked, ahead(walk_));
  }
  EXPECT_LT(swing, walked);
  EXPECT_GT(fall.mean_off, 1 * kRadiansPerDegree);
}

TEST_F(PlayOn, TheSameInputHasTheSameBytes) {
  const Fall first = shoved(walk_, Vec3(75, 0, 10)), again = shoved(walk_, Vec3(75, 0, 10));
  EXPECT_EQ(first.clip.positions, again.clip.positions);
  for (std::size_t k = 0; k < first.clip.orientations.size(); ++k) {
    ASSERT_EQ(first.clip.orientations[k].coeffs(), again.clip.orientations[k].coeffs());
  }
}

// A walk elsewhere in another direction, pushed accordingly, is the same walk there, but for feet
// that slide a little further: the contacts' sweeps end at a tolerance.
TEST_F(PlayOn, WhereItWalksDoesNotMatter) {
  const Transform turn{Vec3(7, 0, -3), from_rotation_vector(Vec3(0, 2.1, 0))};
  Clip turned = walk_;
  std::vector<Transform> pose(walk_.skeleton.names.size());
  for (int frame = 0; frame < walk_.frame_count(); ++frame) {
    walk_.get_pose(frame, pose);
    for (Transform& joint : pose) joint = turn * joint;
    turned.set_pose(frame, pose);
  }
  const Vec3 push(60, 0, 30);
  EXPECT_LT(farthest(shoved(walk_, push).clip, shoved(turned, turn.orientation * push).clip, turn),
            0.02);
}

// A reference pose that lies, joints whose frames are turned at random, and a joint above the hips
// describe the same character.
TEST_F(PlayOn, HowTheSkeletonIsDescribedDoesNotMatter) {
  const Vec3 push(60, 0, 30);
  const Clip plain = shoved(walk_, push).clip;
  Clip lying = walk_;
  const Transform turn{Vec3(1, 2, 0), from_rotation_vector(Vec3(-0.5 * kPi, 0.3, 0))};
  for (Transform& joint : lying.skeleton.reference) joint = turn * joint;
  EXPECT_LT(farthest(plain, shoved(lying, push).clip, {}), 0.005);

  Clip framed = walk_;
  std::mt19937 random(3);
  std::vector<Quat> frames;
  for (int j = 0; j < walk_.joint_count(); ++j) {
    const auto number = [&] { return random() / 4294967296.0 - 0.5; };
    const double x = number(), y = number(), z = number();
    frames.push_back(from_rotation_vector(6 * Vec3(x, y, z)));
    Quat& own = framed.skeleton.reference[at(j)].orientation;
    own = (own * frames.back()).normalized();
  }
  std::vector<Transform> pose(walk_.skeleton.names.size());
  for (int frame = 0; frame < walk_.frame_count(); ++frame) {
    walk_.get_pose(frame, pose);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      pose[j].orientation = (pose[j].orientation * frames[j]).normalized();
    }
    framed.set_pose(frame, pose);
  }
  EXPECT_LT(farthest(plain, shoved(framed, push).clip, {}), 0.005);

  Clip above;
  above.rate = walk_.rate;
  above.skeleton.add("Place", -1, {});
  for (int j = 0; j < walk_.joint_count(); ++j) {
    above.skeleton.add(walk_.skeleton.names[at(j)], walk_.skeleton.parents[at(j)] + 1,
                       walk_.skeleton.reference[at(j)], walk_.skeleton.end_sites[at(j)] != 0);
  }
  above.resize(walk_.frame_count());
  std::vector<Transform> more(pose.size() + 1);
  for (int frame = 0; frame < walk_.frame_count(); ++frame) {
    walk_.get_pose(frame, pose);
    more[0] = {Vec3(0, 0, 0.02 * frame), Quat::Identity()};
    std::copy(pose.begin(), pose.end(), more.begin() + 1);
    above.set_pose(frame, more);
  }
  EXPECT_LT(farthest(plain, shoved(above, push).clip, {}), 0.005);
}

// How much a joint's angular speed relative to its parent differs from one side of a frame to the
// other, by differences of third order, and the speed after it; radians a frame.
struct SpeedJump {
  double jump = 0, speed = 0;
};
SpeedJump speed_jump(const Clip& clip, std::size_t joint, int frame) {
  const auto turn_at = [&](int f) {
    std::vector<Transform> pose(clip.skeleton.names.size()), local(pose.size());
    clip.get_pose(f, pose);
    world_to_local(clip.skeleton.parents, pose, local);
    return local[joint].orientation;
  };
  const Quat now = turn_at(frame);
  const auto rate = [&](int way) {
    const auto turned = [&](int steps) {
      return rotation_vector(turn_at(frame + way * steps) * now.conjugate());
    };
    return Vec3(way * (3 * turned(1) - 1.5 * turned(2) + turned(3) / 3));
  };
  return {(rate(1) - rate(-1)).norm(), rate(1).norm()};
}

// Where the motion goes on alone in the middle of a stagger, no joint's angular speed jumps by more
// than 1 % of the fastest beyond what the motion and the simulation have there themselves (of a
// foot that comes down), and half a second later it is the motion again, bit for bit.
TEST_F(PlayOn, TheMotionGoesOnWithoutAJump) {
  samples::WalkOptions options;
  options.steps = 8;
  options.rate = 240;  // as the simulation: differences of frames are its speeds
  const Clip walk = samples::make_walk(options)->clip;
  const Fall fall = shoved(walk, Vec3(75, 0, 0), false);
  for (const int last : {264, 288, 312}) {  // 0.1 to 0.3 s after the push
    Clip cut = fall.clip;
    cut.resize(last + 1);
    const auto whole = go_on(cut, walk, 0.5);
    ASSERT_TRUE(whole.ok());
    ASSERT_EQ(whole->frame_count(), walk.frame_count());
    double speed = 0;
    for (std::size_t j = 0; j < walk.skeleton.names.size(); ++j) {
      speed = std::max(speed, speed_jump(*whole, j, last).speed);
    }
    for (std::size_t j = 0; j < walk.skeleton.names.size(); ++j) {
      EXPECT_LT(speed_jump(*whole, j, last).jump, 0.01 * speed + speed_jump(walk, j, last).jump)
          << walk.skeleton.names[j] << ' ' << last;
    }
    EXPECT_GT((place(cut, "Spine2", last) - place(walk, "Spine2", last)).norm(), 0.04);
    for (int frame = last + 120; frame < walk.frame_count(); ++frame) {
      for (int j = 0; j < walk.joint_count(); ++j) {
        ASSERT_EQ(whole->frame_positions(frame)[at(j)], walk.frame_positions(frame)[at(j)]);
      }
    }
  }
}

}  // namespace
}  // namespace krok::ragdoll::play_on_test
