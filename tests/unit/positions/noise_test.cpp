// If these fail, fast joints are taken for joints that jump to another place, so that their noise
// stays, or what jumps is smeared over the frames before and after.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "math/types.h"
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

}  // namespace
}  // namespace krok
