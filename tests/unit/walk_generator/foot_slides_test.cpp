// If these fail, the captures with sliding feet that clean-up is tried on do not slide, or differ
// from the walk by something else.

#include "samples/generator/foot_slides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace krok::samples {
namespace {

TEST(FootSlides, MoveEachFootByTheSlideOverItsStanceAndNothingElse) {
  WalkOptions options;
  options.steps = 8;
  options.step_length = 0.5;
  const Walk walk = make_walk(options).value();
  const Clip clip = with_slides(walk, 0.02, 3);
  const RoleMap roles = find_roles(clip.skeleton);
  const auto legs = legs_of(roles);
  const auto moved = [&](int frame, int joint) {
    const auto j = static_cast<std::size_t>(joint);
    return Vec3(
        (clip.frame_positions(frame)[j] - walk.clip.frame_positions(frame)[j]).cast<double>());
  };
  int whole = 0, stances = 0;
  for (const Stance& stance : stances_of(walk)) {
    const int first = static_cast<int>(std::ceil(stance.start * clip.rate)),
              last = static_cast<int>(std::floor(stance.end * clip.rate));
    if (first < 15 || last >= clip.frame_count()) continue;
    const int foot = legs[stance.side].foot;
    ++stances;
    EXPECT_LT(moved(first, foot).norm(), 0.001);
    EXPECT_LT(std::abs(moved(last, foot).y()), 1e-5);
    EXPECT_LT(moved(last, foot).norm(), 0.0201);
    whole += moved(last, foot).norm() > 0.0195 ? 1 : 0;
  }
  EXPECT_GE(stances, 4);
  EXPECT_GE(2 * whole, stances) << "legs are long enough for most slides";
  const int hips = roles.joint(Role::hips), hand = roles.joint(Role::left_hand);
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (const int joint : {hips, hand}) EXPECT_EQ(moved(f, joint), Vec3(Vec3::Zero()));
    for (const LegRoles& leg : legs) {
      const auto shank = [&](const Clip& of) {
        return (of.frame_positions(f)[static_cast<std::size_t>(leg.foot)] -
                of.frame_positions(f)[static_cast<std::size_t>(leg.lower)])
            .norm();
      };
      EXPECT_NEAR(shank(clip), shank(walk.clip), 1e-5);
    }
  }
  EXPECT_EQ(with_slides(walk, 0.02, 3).positions, clip.positions);
  EXPECT_NE(with_slides(walk, 0.02, 4).positions, clip.positions);
}

}  // namespace
}  // namespace krok::samples
