// If these fail, tips of toes stay in the ground after a fall, or toes are thrown about.

#include "ragdoll/toes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "support/human_skeleton.h"

namespace krok::ragdoll {
namespace {

constexpr int kFrames = 121;

// A person whose left foot turns about its ankle, toes down, and back, over two seconds, with the
// ball of the foot 3 cm over the ground.
Clip pointing(double most) {
  Clip clip;
  clip.skeleton = test::human_skeleton(1.8);
  clip.rate = 60;
  clip.resize(kFrames);
  const int foot = clip.skeleton.find("LeftFoot"), ball = clip.skeleton.find("LeftToeBase");
  for (int f = 0; f < kFrames; ++f) {
    std::vector<Transform> pose = clip.skeleton.reference;
    const double angle = most * 0.5 * (1 - std::cos(2 * kPi * f / (kFrames - 1)));
    const Quat turn(Eigen::AngleAxisd(angle, Vec3::UnitX()));
    const Vec3 ankle = pose[at(foot)].position;
    for (const char* name : {"LeftFoot", "LeftToeBase", "LeftToeBase_end"}) {
      Transform& joint = pose[at(clip.skeleton.find(name))];
      joint = {ankle + turn * (joint.position - ankle), turn * joint.orientation};
    }
    const double up = 0.03 - pose[at(ball)].position.y();
    for (Transform& joint : pose) joint.position.y() += up;
    clip.set_pose(f, pose);
  }
  return clip;
}

double lowest(const Clip& clip) {
  const int tip = clip.skeleton.find("LeftToeBase_end");
  double least = 1;
  for (int f = 0; f < clip.frame_count(); ++f) {
    least = std::min(least, static_cast<double>(clip.frame_positions(f)[at(tip)].y()));
  }
  return least;
}

TEST(FallenToes, AreBentOverTheGround) {
  const GroundHeight level = [](double, double) { return std::optional<double>(0); };
  const Clip before = pointing(60 * kRadiansPerDegree);
  ASSERT_LT(lowest(before), -0.02) << "the test has nothing to mend";
  Clip after = before;
  bend_toes(0, find_roles(before.skeleton), {}, level, after);
  EXPECT_GT(lowest(after), -1e-4);
  const int ball = before.skeleton.find("LeftToeBase"), foot = before.skeleton.find("LeftFoot");
  for (int f = 0; f < kFrames; ++f) {
    for (std::size_t j = 0; j < before.skeleton.names.size(); ++j) {
      if (before.skeleton.names[j] == "LeftToeBase_end") continue;
      EXPECT_EQ(after.frame_positions(f)[j], before.frame_positions(f)[j]) << f << ' ' << j;
    }
    if (f == 0) continue;
    const auto turn = [&](int frame) {
      return Quat(after.frame_orientations(frame)[at(foot)].cast<double>().conjugate() *
                  after.frame_orientations(frame)[at(ball)].cast<double>());
    };
    EXPECT_LT(angle_between(turn(f - 1), turn(f)), 10.1 * kRadiansPerDegree) << f;
  }
  // From a frame on; under a roof; in the air; where there is no ground; with a body of their own.
  Clip same = before;
  bend_toes(kFrames, find_roles(before.skeleton), {}, level, same);
  bend_toes(
      0, find_roles(before.skeleton), {}, [](double, double) { return std::optional<double>(2.5); },
      same);
  bend_toes(
      0, find_roles(before.skeleton), {}, [](double, double) { return std::optional<double>(-1); },
      same);
  bend_toes(
      0, find_roles(before.skeleton), {}, [](double, double) { return std::optional<double>(); },
      same);
  Body toes;
  toes.joint = ball;
  bend_toes(0, find_roles(before.skeleton), {toes}, level, same);
  EXPECT_EQ(same.positions, before.positions);
}

}  // namespace
}  // namespace krok::ragdoll
