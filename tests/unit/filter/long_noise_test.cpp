// If this fails, --filter auto of a long take leaves more noise than that of a short one, or shows
// where its blocks meet.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "filter/noise_filter.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "samples/generator/walk.h"

namespace krok::filter {
namespace {

// Root mean squares of the joints' rotations between two motions, and of what they change by from
// a frame to the next, in frames [begin, end).
struct Distance {
  double angle = 0, step = 0;
};
Distance distance_of(const LocalMotion& a, const LocalMotion& b, int begin, int end) {
  double angle = 0, step = 0;
  for (int j = 0; j < a.joints; ++j) {
    Vec3 last = Vec3::Zero();
    for (int f = begin; f < end; ++f) {
      const Vec3 off = rotation_vector(a.at(j, f).orientation.conjugate() * b.at(j, f).orientation);
      angle += off.squaredNorm();
      if (f > begin) step += (off - last).squaredNorm();
      last = off;
    }
  }
  const double count = static_cast<double>(end - begin) * a.joints;
  return {std::sqrt(angle / count), std::sqrt(step / count)};
}

TEST(RemoveNoise, InBlocksAsInOne) {
  samples::WalkOptions options;
  options.steps = 120;
  options.seed = 6;
  const Clip truth = samples::make_walk(options).value().clip;
  options.noise_angle = kRadiansPerDegree;
  options.noise_position = 0.003;
  const Clip noisy = samples::make_walk(options).value().clip;
  const int frames = noisy.frame_count(), block = 1200;
  ASSERT_GT(frames, 5 * block / 2);
  const auto whole = remove_noise(noisy, {});
  std::vector<Spike> spikes;
  int watched = 0;
  const auto watch = [&](const FrameRun& before, const NoiseRemoval& after) {
    spikes.insert(spikes.end(), after.spikes.begin(), after.spikes.end());
    watched += before.kept_end - before.kept_begin;
    EXPECT_EQ(before.clip.frame_orientations(before.kept_begin)[1].coeffs(),
              noisy.frame_orientations(before.first + before.kept_begin)[1].coeffs());
  };
  const auto made = remove_noise(frames_of(noisy), {}, 2, watch, block);
  ASSERT_TRUE(made.ok());
  EXPECT_NEAR(made->angle, whole->angle, 0.05 * whole->angle);
  EXPECT_NEAR(made->distance, whole->distance, 0.1 * whole->distance);
  const Clip many = load(made->frames, 1).value();
  EXPECT_EQ(watched, frames);

  const LocalMotion a = local_motion(many), b = local_motion(whole->clip), c = local_motion(truth);
  const Distance left = distance_of(b, c, 0, frames), apart = distance_of(a, b, 0, frames);
  EXPECT_LT(apart.angle, 0.05 * left.angle);
  EXPECT_LT(distance_of(a, c, 0, frames).angle, 1.02 * left.angle);
  for (int seam = block; seam < frames; seam += block) {
    const Distance there = distance_of(a, b, seam - 2, seam + 2);
    EXPECT_LT(there.step, 0.05 * left.step) << seam;
  }
  EXPECT_EQ(spikes.size(), whole->spikes.size());
  const auto again = remove_noise(frames_of(noisy), {}, 1, {}, block);
  const Clip last = load(part_of(again->frames, frames - 1, 1), 1).value();
  EXPECT_TRUE(std::ranges::equal(last.positions, many.frame_positions(frames - 1)));
}

}  // namespace
}  // namespace krok::filter
