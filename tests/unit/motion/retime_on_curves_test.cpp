// If these fail, motions resampled along Hermite curves leave their frames, bend at them, or do not
// stop at them with full tension.

#include "motion/sample.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/quaternion.h"

namespace krok {
namespace {

Skeleton hips_and_chest() {
  Skeleton skeleton;
  skeleton.add("Hips", Skeleton::kNoParent, {Vec3(0, 1, 0), Quat::Identity()});
  skeleton.add("Chest", 0, {Vec3(0, 1.5, 0), Quat::Identity()});
  return skeleton;
}

// The hips go along a parabola, the chest turns about x by one: what Catmull and Rom's
// curves reproduce, as differences over two intervals are exact velocities of it.
Clip on_parabola(int frames, double rate) {
  Clip clip;
  clip.skeleton = hips_and_chest();
  clip.rate = rate;
  clip.resize(frames);
  for (int f = 0; f < frames; ++f) {
    const double t = f / rate;
    const Transform hips{Vec3(t * t, 1, 2 * t), Quat::Identity()};
    const Quat turn(Eigen::AngleAxisd(0.4 * t * t, Vec3::UnitX()));
    clip.set_pose(f, std::vector<Transform>{hips, hips * Transform{Vec3(0, 0.5, 0), turn}});
  }
  return clip;
}

TEST(RetimeOnCurves, QuadraticsAreExactAwayFromTheEnds) {
  const Clip few = on_parabola(11, 5);
  const auto many = retime_on_curves(few, 60, 1, 0, false);
  ASSERT_TRUE(many.ok());
  ASSERT_EQ(many->frame_count(), 121);
  for (int f = 12; f <= 108; ++f) {
    const double t = f / 60.0;
    EXPECT_NEAR(many->frame_positions(f)[0].x(), t * t, 1e-5) << f;
    EXPECT_NEAR(many->frame_positions(f)[0].z(), 2 * t, 1e-5) << f;
    const Quat turn = many->frame_orientations(f)[1].cast<double>();
    EXPECT_LT(angle_between(turn, Quat(Eigen::AngleAxisd(0.4 * t * t, Vec3::UnitX()))), 1e-5) << f;
  }
}

TEST(RetimeOnCurves, FramesStayAndFullTensionStopsAtThem) {
  const Clip few = on_parabola(6, 4);
  for (const double tension : {0.0, 0.5, 1.0}) {
    const auto many = retime_on_curves(few, 400, 1, tension, false);
    ASSERT_TRUE(many.ok());
    for (int k = 0; k < 6; ++k) {
      EXPECT_LT((many->frame_positions(100 * k)[1] - few.frame_positions(k)[1]).norm(), 1e-5F);
    }
    const double speed =
        400.0 * (many->frame_positions(301)[0] - many->frame_positions(300)[0]).norm();
    // At 0.75 s: (1.5, 2) m/s, less by the tension.
    EXPECT_NEAR(speed, (1 - tension) * 2.5, 0.1) << tension;
  }
}

TEST(RetimeOnCurves, SpeedAndKeptEndsAreThoseOfRetime) {
  const Clip clip = on_parabola(11, 10);
  const auto faster = retime_on_curves(clip, 30, 2, 0, false);
  ASSERT_TRUE(faster.ok());
  EXPECT_EQ(faster->frame_count(), 16);
  EXPECT_NEAR(faster->frame_positions(6)[0].x(), 0.16, 1e-5);
  const auto kept = retime_on_curves(clip, 7, 1.1, 0, true);
  ASSERT_TRUE(kept.ok());
  EXPECT_LT(
      (kept->frame_positions(kept->frame_count() - 1)[1] - clip.frame_positions(10)[1]).norm(),
      1e-5F);
  EXPECT_FALSE(retime_on_curves(clip, 30, 0, 0, false).ok());
  EXPECT_FALSE(retime_on_curves(clip, 30, 1, 2, false).ok());
  Clip none;
  none.skeleton = hips_and_chest();
  none.rate = 30;
  EXPECT_TRUE(retime_on_curves(none, 60, 1, 0, false).ok());
}

}  // namespace
}  // namespace krok
