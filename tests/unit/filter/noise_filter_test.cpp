// If these fail, --filter auto smooths by another amount than the noise that is there, takes fast
// motion for spikes, misses spikes in the noise, or depends on the number of threads.

#include "filter/noise_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "filter/series_denoiser.h"
#include "filter/smooth_clip.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "samples/generator/noise.h"
#include "samples/generator/walk.h"

namespace krok::filter {
namespace {

Clip noise_test_walk(double noise_degrees) {
  samples::WalkOptions options;
  options.steps = 6;
  options.noise_angle = noise_degrees * kRadiansPerDegree;
  options.noise_position = noise_degrees * 0.003;
  options.seed = 9;
  return samples::make_walk(options).value().clip;
}

double mean_distance(const Clip& a, const Clip& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    sum += (a.positions[i] - b.positions[i]).cast<double>().norm();
  }
  return sum / static_cast<double>(a.positions.size());
}

Clip turned(const Clip& clip, int joint, const std::vector<std::pair<int, double>>& angles) {
  LocalMotion motion = local_motion(clip);
  for (const auto& [frame, angle] : angles) {
    Transform local = motion.at(joint, frame);
    local.orientation = local.orientation * from_rotation_vector(Vec3(angle, 0, 0));
    motion.set(joint, frame, local);
  }
  Clip result = clip;
  set_local_motion(motion, result);
  return result;
}

// A joint that stands, then swings at 3 Hz: one strength for both would keep the noise or the
// swing.
TEST(WithoutNoise, FollowsAChangeFromStandingToSwinging) {
  samples::NoiseSource noise(5);
  constexpr Eigen::Index kHalf = 150;
  Eigen::MatrixXd truth = Eigen::MatrixXd::Zero(2 * kHalf, 6), series(2 * kHalf, 6);
  for (Eigen::Index f = kHalf; f < 2 * kHalf; ++f) {
    truth.row(f).setConstant(20 * (1 - std::cos(0.2 * kPi * static_cast<double>(f - kHalf))));
  }
  for (double& value : series.reshaped()) value = noise.gaussian();
  series += truth;
  const Eigen::MatrixXd smooth = without_noise_in_parts(series, 30, 1);
  EXPECT_EQ(smooth, without_noise_in_parts(series, 30, 4));
  const Eigen::MatrixXd off = smooth - truth;
  EXPECT_LT(std::sqrt(off.topRows(kHalf - 15).array().square().mean()), 0.35);
  EXPECT_LT(std::sqrt(off.bottomRows(kHalf - 15).array().square().mean()), 0.75);
}

TEST(WhittakerSmoother, SolvesItsEquations) {
  samples::NoiseSource noise(3);
  constexpr int kSize = 40;
  Eigen::VectorXd data(kSize), weights = Eigen::VectorXd::Ones(kSize);
  for (double& value : data) value = noise.gaussian();
  Eigen::MatrixXd second = Eigen::MatrixXd::Zero(kSize - 2, kSize);
  for (int i = 0; i + 2 < kSize; ++i) second.block<1, 3>(i, i) << 1, -2, 1;
  for (const double lambda : {0.3, 50.0, 1e5}) {
    for (const bool weighted : {false, true}) {
      if (weighted)
        weights[7] = weights[8] = weights[39] = 0;
      else
        weights.setOnes();
      const Eigen::MatrixXd matrix =
          Eigen::MatrixXd(weights.asDiagonal()) + lambda * second.transpose() * second;
      const Eigen::VectorXd expected = matrix.ldlt().solve(weights.cwiseProduct(data));
      const std::vector<double> given(weights.begin(), weights.end());
      const Whittaker smoother(
          kSize, lambda, weighted ? std::span<const double>(given) : std::span<const double>());
      std::vector<double> series(data.begin(), data.end()), both;
      for (const double value : data) both.insert(both.end(), {value, -2 * value});
      smoother.smooth(series);
      smoother.smooth(both, 2);
      for (int i = 0; i < kSize; ++i) {
        const auto place = static_cast<std::size_t>(i);
        EXPECT_NEAR(series[place], expected[i], 1e-9) << lambda << " " << i;
        EXPECT_EQ(both[2 * place], series[place]);
        EXPECT_EQ(both[2 * place + 1], -2 * series[place]);
      }
      if (!weighted) {
        EXPECT_NEAR(smoother.freedom(), matrix.inverse().trace(), 1);
      }
    }
  }
}

TEST(NoiseFilter, EstimatesTheNoise) {
  const auto removal = remove_noise(noise_test_walk(1), {});
  ASSERT_TRUE(removal.ok());
  EXPECT_NEAR(removal->angle / kRadiansPerDegree, 1, 0.1);
  EXPECT_NEAR(removal->distance, 0.003, 0.0006);
}

// At any cutoff that Butterworth could be given.
TEST(NoiseFilter, IsNearerToTheTruthThanALowPass) {
  const Clip truth = noise_test_walk(0), noisy = noise_test_walk(1);
  double lowest = 1;
  for (const double cutoff : {3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0}) {
    const auto smoothed = smooth(noisy, Butterworth{cutoff, 4}, {});
    ASSERT_TRUE(smoothed.ok());
    lowest = std::min(lowest, mean_distance(*smoothed, truth));
  }
  const auto removal = remove_noise(noisy, {});
  ASSERT_TRUE(removal.ok());
  EXPECT_LT(mean_distance(removal->clip, truth), 0.8 * lowest);
  EXPECT_TRUE(removal->spikes.empty());
}

TEST(NoiseFilter, FindsSpikesThatNoiseHides) {
  const Clip truth = noise_test_walk(0);
  const int arm = truth.skeleton.find("LeftForeArm");
  // Under the limit of remove_spikes() for one degree of noise.
  const double size = 9 * kRadiansPerDegree;
  const Clip spoilt = turned(noise_test_walk(1), arm, {{50, size}, {120, -size}, {171, size}});
  ASSERT_TRUE(remove_spikes(spoilt, {}, {})->spikes.empty());
  const auto removal = remove_noise(spoilt, {});
  ASSERT_TRUE(removal.ok());
  ASSERT_EQ(removal->spikes.size(), 3u);
  EXPECT_EQ(removal->spikes[0].joint, arm);
  EXPECT_EQ(removal->spikes[0].first_frame, 50);
  EXPECT_EQ(removal->spikes[2].first_frame, 171);
  EXPECT_NEAR(removal->spikes[1].size, size, 3 * kRadiansPerDegree);
}

// A kick: a shank that turns by 20 degrees from a frame to the next, there and back in 0.2 s.
TEST(NoiseFilter, FastMotionIsNoSpike) {
  for (const double noise : {0.0, 1.0}) {
    const Clip walk = noise_test_walk(noise);
    std::vector<std::pair<int, double>> kick;
    for (int f = 90; f <= 110; ++f) {
      kick.emplace_back(f, 70 * kRadiansPerDegree * std::exp(-0.5 * std::pow((f - 100) / 2.2, 2)));
    }
    const int shank = walk.skeleton.find("LeftLeg");
    const Clip kicked = turned(walk, shank, kick);
    const auto removal = remove_noise(kicked, {});
    ASSERT_TRUE(removal.ok());
    EXPECT_TRUE(removal->spikes.empty()) << noise;
    const Clip truth = turned(noise_test_walk(0), shank, kick);
    const double off = angle_between(local_motion(removal->clip).at(shank, 100).orientation,
                                     local_motion(truth).at(shank, 100).orientation);
    EXPECT_LT(off, (noise == 0 ? 0.5 : 8) * kRadiansPerDegree) << noise;
  }
}

TEST(NoiseFilter, CleanMotionStays) {
  const Clip truth = noise_test_walk(0);
  const auto removal = remove_noise(truth, {});
  ASSERT_TRUE(removal.ok());
  EXPECT_TRUE(removal->spikes.empty());
  EXPECT_LT(mean_distance(removal->clip, truth), 1e-3);
}

TEST(NoiseFilter, TheSameBytesForAnyNumberOfThreads) {
  const Clip noisy = noise_test_walk(1);
  const auto one = remove_noise(noisy, {}, 1), four = remove_noise(noisy, {}, 4);
  ASSERT_TRUE(one.ok() && four.ok());
  EXPECT_EQ(one->clip.positions, four->clip.positions);
}

TEST(NoiseFilter, ShortOrSelected) {
  Clip noisy = noise_test_walk(1);
  std::vector<std::uint8_t> joints(noisy.skeleton.names.size(), 0);
  EXPECT_EQ(remove_noise(noisy, joints)->clip.positions, noisy.positions);
  for (const int frames : {0, 1, 4, 19, 20, 23}) {
    Clip few = noisy;
    few.resize(frames);
    const auto removal = remove_noise(few, {});
    ASSERT_TRUE(removal.ok()) << frames;
    EXPECT_TRUE(krok::check(removal->clip).ok()) << frames;
    if (frames < 20) {
      EXPECT_EQ(removal->clip.positions, few.positions);
    }
  }
}

}  // namespace
}  // namespace krok::filter
