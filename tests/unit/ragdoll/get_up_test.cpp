// If these fail, what gets up jumps, goes through the ground, chooses a motion from another side
// than it lies on, or loses the fall or the motion on the way.

#include "ragdoll/get_up.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/mirror.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "samples/generator/rise.h"

namespace krok::ragdoll {
namespace {

using samples::Lying;

std::optional<double> level(double, double) {
  return 0.0;
}

class GetUp : public testing::Test {
 protected:
  GetUp() {
    for (const Lying from : {Lying::front, Lying::back, Lying::side}) {
      samples::RiseOptions options;
      options.from = from;
      motions_.push_back(*samples::make_rise(options));
    }
    roles_ = find_roles(motions_[0].skeleton);
    bodies_ = *make_bodies(motions_[0].skeleton, roles_);
  }

  // Lies as a motion begins, elsewhere, turned and with limbs put elsewhere; half a second.
  Clip lying(std::size_t motion, double turn, double bend) const {
    Clip clip = cut(motions_[motion], 0, 0);
    LocalMotion local = local_motion(clip);
    const Skeleton& skeleton = clip.skeleton;
    for (const char* name : {"LeftArm", "RightForeArm", "LeftLeg", "RightUpLeg"}) {
      const int joint = skeleton.find(name);
      Transform now = local.at(joint, 0);
      now.orientation = now.orientation * axis_rotation(Axis::z, bend);
      local.set(joint, 0, now);
    }
    set_local_motion(local, clip);
    move_clip({Vec3(3, 0, -2), axis_rotation(Axis::y, turn)}, clip);
    std::vector<Transform> pose(skeleton.names.size());
    clip.get_pose(0, pose);
    // On the limbs that are put below.
    const double depth = depth_in_ground(bodies_, pose, level);
    for (Transform& joint : pose) joint.position.y() += depth;
    clip.resize(31);
    for (int f = 0; f < 31; ++f) clip.set_pose(f, pose);
    return clip;
  }

  RisenClip up(const Clip& fall) const {
    auto risen = get_up(fall, 20, motions_, roles_, bodies_, {});
    EXPECT_TRUE(risen.ok());
    return std::move(*risen);
  }

  // How much the speed of a joint differs from one side of a frame to the other, by differences of
  // second order, over the speed of the fastest joint from lying to standing.
  static double speed_jump(const RisenClip& risen, int frame) {
    double jump = 0, speed = 0;
    const Clip& clip = risen.clip;
    for (int j = 0; j < clip.joint_count(); ++j) {
      const auto place = [&](int f) { return Vec3(clip.frame_positions(f)[at(j)].cast<double>()); };
      const Vec3 before = 1.5 * place(frame) - 2 * place(frame - 1) + 0.5 * place(frame - 2);
      const Vec3 after = -1.5 * place(frame) + 2 * place(frame + 1) - 0.5 * place(frame + 2);
      jump = std::max(jump, (after - before).norm());
      for (int f = risen.first_frame; f + 1 < clip.frame_count(); ++f) {
        speed = std::max(speed, (place(f + 1) - place(f)).norm());
      }
    }
    return jump / speed;
  }

  std::vector<Clip> motions_;
  RoleMap roles_;
  std::vector<Body> bodies_;
};

TEST_F(GetUp, TheSideThatItLiesOnChooses) {
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    for (const double turn : {0.0, 1.9, -2.7}) {
      const RisenClip risen = up(lying(m, turn, 0.3));
      EXPECT_EQ(risen.choice.motion, static_cast<int>(m));
      EXPECT_FALSE(risen.choice.mirrored && m == 2);
      EXPECT_EQ(risen.tried.size(), 3u);
    }
  }
  // On the other side, the mirror image.
  const Clip other = mirror(lying(2, 0.5, 0.3), find_mirror_pairs(motions_[0].skeleton, roles_));
  const RisenClip risen = up(other);
  EXPECT_EQ(risen.choice.motion, 2);
  EXPECT_TRUE(risen.choice.mirrored);
}

TEST_F(GetUp, NothingJumpsOrSinks) {
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    for (const double bend : {0.0, 0.5, -0.7}) {
      const RisenClip risen = up(lying(m, 2.2, bend));
      EXPECT_LE(risen.acceleration, 1.5 * risen.motion_acceleration) << m << " " << bend;
      std::vector<Transform> pose(risen.clip.skeleton.names.size());
      for (int f = risen.first_frame; f < risen.clip.frame_count(); ++f) {
        risen.clip.get_pose(f, pose);
        EXPECT_LT(depth_in_ground(bodies_, pose, level), 0.01) << m << " " << bend << " " << f;
      }
      EXPECT_LT(speed_jump(risen, risen.handover), 0.01) << m << " " << bend;
    }
  }
}

// The same with a root above the hips that stands elsewhere and has another up axis, as many sets
// have: a lift along that root's axes would take the body out of the world.
TEST_F(GetUp, ARootAboveTheHipsDoesNotMatter) {
  const auto with_root = [](const Clip& clip, double turn) {
    const Transform root{Vec3(20, 1, -5), axis_rotation(Axis::y, turn) * axis_rotation(Axis::x, 2)};
    Clip result;
    result.rate = clip.rate;
    result.skeleton.add("Reference", -1, root);
    for (std::size_t j = 0; j < clip.skeleton.names.size(); ++j) {
      result.skeleton.add(clip.skeleton.names[j], clip.skeleton.parents[j] + 1,
                          clip.skeleton.reference[j], clip.skeleton.end_sites[j] != 0);
    }
    result.resize(clip.frame_count());
    std::vector<Transform> pose(clip.skeleton.names.size());
    for (int f = 0; f < clip.frame_count(); ++f) {
      clip.get_pose(f, pose);
      std::vector<Transform> all = {root};
      all.insert(all.end(), pose.begin(), pose.end());
      result.set_pose(f, all);
    }
    return result;
  };
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    const Clip fall = lying(m, 2.2, 0.5);
    const Clip expected = up(fall).clip;
    std::vector<Clip> motions;
    for (const Clip& motion : motions_) motions.push_back(with_root(motion, 3));
    const Clip other = with_root(fall, 0);
    const RoleMap roles = find_roles(other.skeleton);
    const auto bodies = *make_bodies(other.skeleton, roles);
    const auto risen = get_up(other, 20, motions, roles, bodies, {});
    ASSERT_TRUE(risen.ok());
    ASSERT_EQ(risen->clip.frame_count(), expected.frame_count()) << m;
    for (int f = 0; f < expected.frame_count(); ++f) {
      for (std::size_t j = 0; j < expected.skeleton.names.size(); ++j) {
        ASSERT_LT((risen->clip.frame_positions(f)[j + 1] - expected.frame_positions(f)[j]).norm(),
                  1e-3f)
            << m << " " << f;
      }
    }
  }
}

// Up to the first frame it is the fall, from the handover on the motion, moved and turned.
TEST_F(GetUp, FallAndMotionStayWhatTheyAre) {
  const Clip fall = lying(1, 0.8, 0.2);
  const RisenClip risen = up(fall);
  EXPECT_EQ(risen.first_frame, 20);
  for (int f = 0; f <= 20; ++f) {
    for (std::size_t j = 0; j < fall.skeleton.names.size(); ++j) {
      EXPECT_LT((risen.clip.frame_positions(f)[j] - fall.frame_positions(f)[j]).norm(), 1e-5f);
    }
  }
  const Clip& motion = motions_[1];
  const int last = risen.clip.frame_count() - 1, end = motion.frame_count() - 1;
  for (int back = 0; back < last - risen.handover - 15; back += 7) {
    for (int j = 0; j < motion.joint_count(); ++j) {
      const int parent = motion.skeleton.parents[at(j)];
      if (parent < 0) continue;
      const auto turn = [&](const Clip& clip, int f) {
        return Quat(clip.frame_orientations(f)[at(parent)].cast<double>().conjugate() *
                    clip.frame_orientations(f)[at(j)].cast<double>());
      };
      EXPECT_LT(angle_between(turn(risen.clip, last - back), turn(motion, end - back)), 0.02)
          << motion.skeleton.names[at(j)] << " " << back;
    }
  }
}

// A turned and moved fall gives the same, turned and moved.
TEST_F(GetUp, WhereItLiesDoesNotMatter) {
  const RisenClip here = up(lying(0, 0, 0.4)), there = up(lying(0, 2.5, 0.4));
  ASSERT_EQ(here.clip.frame_count(), there.clip.frame_count());
  EXPECT_NEAR(here.choice.distance, there.choice.distance, 1e-5);
  const int last = here.clip.frame_count() - 1;
  for (int j = 0; j < here.clip.joint_count(); ++j) {
    EXPECT_NEAR(here.clip.frame_positions(last)[at(j)].y(),
                there.clip.frame_positions(last)[at(j)].y(), 1e-3);
  }
}

// Would fail if a body rose from lying to standing as a whole, stiff as a board, within a second.
TEST_F(GetUp, AMotionThatBeginsStandingComesAfterACrouch) {
  Clip standing = cut(motions_[0], motions_[0].frame_count() - 1, motions_[0].frame_count() - 1);
  std::vector<Transform> pose(standing.skeleton.names.size());
  standing.get_pose(0, pose);
  standing.resize(60);
  for (int f = 0; f < 60; ++f) standing.set_pose(f, pose);
  const int hips = roles_.joint(Role::hips);
  const double height = pose[at(hips)].position.y();
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    const auto risen = get_up(lying(m, 1.2, 0.3), 20, {&standing, 1}, roles_, bodies_, {});
    ASSERT_TRUE(risen.ok()) << risen.error().message;
    EXPECT_TRUE(risen->crouches);
    const Clip& clip = risen->clip;
    const auto place = [&](int f, Role role) {
      return Vec3(clip.frame_positions(f)[at(roles_.joint(role))].cast<double>());
    };
    // From where the hips are over half their height for good.
    int rises = clip.frame_count() - 1, stands = rises;
    while (rises > 0 && place(rises, Role::hips).y() > 0.5 * height) --rises;
    while (stands > 0 && place(stands, Role::hips).y() > 0.99 * height) --stands;
    const Vec3 feet = 0.5 * (place(rises, Role::left_foot) + place(rises, Role::right_foot));
    const Vec3 beside = place(rises, Role::hips) - feet;
    EXPECT_LT(Vec3(beside.x(), 0, beside.z()).norm(), 0.3 * height) << m;
    double hands = height, speed = 0;
    for (int f = risen->first_frame; f <= rises; ++f) {
      if (place(f, Role::hips).y() < 0.35 * height) continue;
      hands = std::min({hands, place(f, Role::left_hand).y(), place(f, Role::right_hand).y()});
    }
    EXPECT_LT(hands, 0.25 * height) << m;
    for (int f = risen->first_frame; f < stands; ++f) {
      speed = std::max(speed, clip.rate * (place(f + 1, Role::hips) - place(f, Role::hips)).y());
    }
    EXPECT_LT(speed, 1.0) << m;
    const double seconds = (stands - risen->first_frame) / clip.rate;
    EXPECT_GT(seconds, 2) << m;
    EXPECT_LT(seconds, 6) << m;
    EXPECT_LT(risen->depth, 0.005) << m;
  }
  EXPECT_FALSE(up(lying(0, 0, 0)).crouches);
}

TEST_F(GetUp, OtherSkeletonsAreTold) {
  samples::RiseOptions small;
  small.stature = 1.4;
  const Clip other = *samples::make_rise(small);
  const auto risen = get_up(lying(0, 0, 0), 20, {&other, 1}, roles_, bodies_, {});
  ASSERT_FALSE(risen.ok());
  EXPECT_EQ(risen.error().code, "motion-skeleton");
  EXPECT_EQ(get_up(lying(0, 0, 0), 20, {}, roles_, bodies_, {}).error().code, "ragdoll-rise");
}

}  // namespace
}  // namespace krok::ragdoll
