// If these fail, fast joints are taken for joints that jump to another place, so that their noise
// stays, or what jumps is smeared over the frames before and after; or a joint that is elsewhere
// for a frame pulls its neighbours and the lengths of bones.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "math/transform.h"
#include "positions/from_positions.h"
#include "samples/generator/noise.h"

namespace krok {
namespace {

constexpr int kFrames = 120;
constexpr double kRate = 20, kNoise = 0.005;

// Root mean square distance of joints to their places after smoothing, in units of the noise, in
// the 20 frames around `middle`.
double error_left(double radius, double jump, int middle) {
  std::vector<Vec3> places;
  for (const double along : {0.0, 0.3}) {
    for (int f = 0; f < kFrames; ++f) {
      // At rest for 4 seconds, then quick.
      const double angle = 0.75 * std::log1p(std::exp(8 * (f / kRate - 4)));
      places.emplace_back(radius * std::cos(angle) + (f < 20 ? jump : 0), along,
                          radius * std::sin(angle));
    }
  }
  std::vector<Vec3> tracks = places;
  samples::NoiseSource noise(7);
  for (Vec3& place : tracks) {
    for (double& value : place) value += kNoise * noise.gaussian();
  }
  smooth_tracks(std::vector(2, kNoise), kRate, 1, tracks);
  double squares = 0;
  for (const int joint : {0, 1}) {
    for (int f = middle - 10; f < middle + 10; ++f) {
      const auto i = static_cast<std::size_t>(joint * kFrames + f);
      squares += (tracks[i] - places[i]).squaredNorm();
    }
  }
  return std::sqrt(squares / 40) / kNoise;
}

TEST(PositionNoise, FastJointsDoNotJump) {
  EXPECT_LT(error_left(0.5, 0, 105), 1.1);  // 3 m/s
}

TEST(PositionNoise, JumpsStay) {
  EXPECT_LT(error_left(0.05, 2, 20), 0.7);
}

TEST(PositionNoise, GlitchesAreFilled) {
  // An arm that swings: shoulder, elbow, hand.
  const std::vector<int> parents = {-1, 0, 1};
  std::vector<Vec3> places;
  for (int f = 0; f < kFrames; ++f) {
    const double angle = std::sin(3 * f / kRate);
    for (const double along : {0.0, 0.3, 0.55}) {
      places.emplace_back(along * std::cos(angle), 1.4, along * std::sin(angle));
    }
  }
  const auto place_of = [](int frame, int joint) {
    return static_cast<std::size_t>(3 * frame + joint);
  };
  std::vector<Vec3> tracks = places;
  tracks[place_of(0, 2)] += Vec3(0.4, 0, 0);
  for (const int f : {40, 41}) tracks[place_of(f, 1)] += Vec3(0, 0.4, 0);
  tracks[place_of(50, 2)].setConstant(std::nan(""));
  // For a second: no glitch.
  for (int f = 60; f < 80; ++f) tracks[place_of(f, 2)] *= 1.2;
  const std::vector<Vec3> before = tracks;
  EXPECT_EQ(remove_glitches(parents, kRate, tracks), (std::vector<int>{0, 2, 1}));
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    EXPECT_LT((tracks[i] - (i < place_of(60, 0) ? places : before)[i]).norm(), 0.05) << i;
  }
  EXPECT_LT((tracks[place_of(50, 2)] - places[place_of(50, 2)]).norm(), 0.003);
}

// Would fail if an end site that lies in its joint but for a tenth of a millimetre made a rigid
// body one whose bones change their lengths, or if bones that do were missed.
TEST(PositionNoise, BonesOfHardlyAnyLengthDoNotCount) {
  Skeleton skeleton;
  skeleton.add("shoulder", -1, {Vec3::Zero(), Quat::Identity()});
  skeleton.add("elbow", 0, {Vec3(0.3, 0, 0), Quat::Identity()});
  skeleton.add("hand", 1, {Vec3(0.55, 0, 0), Quat::Identity()});
  skeleton.add("hand_end", 2, {Vec3(0.55, 0, 0), Quat::Identity()});
  for (const double breath : {0.0, 0.4}) {
    std::vector<Vec3> places;
    for (int f = 0; f < kFrames; ++f) {
      const double size = 1 + breath * std::sin(f);
      for (const double along : {0.0, 0.3, 0.55, 0.55}) places.emplace_back(size * along, 1.4, 0);
      places.back().z() += 1e-4 * (f % 3);
    }
    const auto made = from_positions({skeleton, {}, places, kRate, false});
    EXPECT_NEAR(made.length_variation, 0.71 * breath, 0.02) << breath;
  }
}

TEST(PositionNoise, GapsTurnWithTheirBones) {
  const Vec3 gap = Vec3::Constant(std::nan(""));
  const std::vector<int> parents = {-1, 0};
  std::vector<Vec3> track = {gap, {2, 0, 0}, {1, 0, 0}, {2, 0, 0}, gap,
                             gap, {3, 0, 0}, {3, 1, 0}, gap,       gap};
  EXPECT_TRUE(fill_gaps(parents, track));
  EXPECT_EQ(track[0], Vec3(1, 0, 0));
  EXPECT_EQ(track[1], Vec3(2, 0, 0));
  EXPECT_LT((track[4] - Vec3(2, 0, 0)).norm(), 1e-9);
  EXPECT_LT((track[5] - Vec3(2 + std::sqrt(0.5), std::sqrt(0.5), 0)).norm(), 1e-9);
  EXPECT_EQ(track[9], Vec3(3, 1, 0));
  std::vector<Vec3> empty = {{0, 0, 0}, gap};
  EXPECT_FALSE(fill_gaps(parents, empty));
}

}  // namespace
}  // namespace krok
