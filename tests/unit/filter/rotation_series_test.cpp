// If these fail, rotations are filtered like numbers that they are not: the result would depend on
// the axes a joint happens to have, turn at another pace, or be pulled off where nothing jitters.

#include "filter/smooth_clip.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/quaternion.h"
#include "samples/generator/noise.h"

namespace krok::filter {
namespace {

constexpr double kRate = 60;

SeriesFilter butterworth(double cutoff = 6, int order = 4) {
  const Butterworth filter{cutoff, order};
  return [sections = design(filter, kRate).value(), padding = padding_for(filter, kRate)](
             std::span<double> series) { filter_both_ways(sections, padding, series); };
}

SeriesFilter savgol() {
  return [smoother = PolynomialSmoother({9, 3})](std::span<double> series) {
    smoother.smooth(series);
  };
}

std::vector<SeriesFilter> both() {
  return {butterworth(), savgol()};
}

std::vector<Quat> filtered(const SeriesFilter& filter, std::vector<Quat> series) {
  smooth_rotations(filter, series);
  return series;
}

// A lively motion about changing axes.
std::vector<Quat> tumbling(int frames) {
  std::vector<Quat> series;
  for (int t = 0; t < frames; ++t) {
    const double s = t / kRate;
    series.push_back(from_rotation_vector(Vec3(0, 3 * s, 0)) *
                     from_rotation_vector(Vec3(0.9 * std::sin(7 * s), 0, 0)) *
                     from_rotation_vector(Vec3(0, 0, 0.5 * std::cos(11 * s + 1))));
  }
  return series;
}

std::vector<Quat> with_noise(std::vector<Quat> series, double deviation, std::uint64_t seed) {
  samples::NoiseSource noise(seed);
  for (Quat& q : series) {
    const double x = noise.gaussian(), y = noise.gaussian(), z = noise.gaussian();
    q = q * from_rotation_vector(deviation * Vec3(x, y, z));
  }
  return series;
}

double rms(const std::vector<Quat>& a, const std::vector<Quat>& b) {
  double sum = 0;
  for (std::size_t t = 0; t < a.size(); ++t) sum += std::pow(angle_between(a[t], b[t]), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

double largest(const std::vector<Quat>& a, const std::vector<Quat>& b) {
  double most = 0;
  for (std::size_t t = 0; t < a.size(); ++t) most = std::max(most, angle_between(a[t], b[t]));
  return most;
}

TEST(SmoothRotations, DoNotDependOnTheFramesOfJointAndParent) {
  const Quat left = from_rotation_vector(Vec3(1.1, -2.0, 0.4));
  const Quat right = from_rotation_vector(Vec3(-0.3, 0.8, 2.5));
  const auto given = with_noise(tumbling(200), 0.05, 7);
  std::vector<Quat> turned;
  for (const Quat& q : given) turned.push_back(left * q * right);
  for (const SeriesFilter& filter : both()) {
    auto expected = filtered(filter, given);
    for (Quat& q : expected) q = left * q * right;
    EXPECT_LT(largest(filtered(filter, turned), expected), 1e-12);
  }
}

TEST(SmoothRotations, SignsOfQuaternionsMeanNothing) {
  auto given = with_noise(tumbling(100), 0.05, 3);
  const auto expected = filtered(butterworth(), given);
  for (std::size_t t = 0; t < given.size(); t += 3) given[t].coeffs() *= -1;
  EXPECT_LT(largest(filtered(butterworth(), given), expected), 1e-12);
}

TEST(SmoothRotations, LeaveRestAndUniformRotationAlone) {
  const Vec3 axis = Vec3(1, 2, -1).normalized();
  for (const double turns_a_second : {0.0, 0.3, 5.0, 20.0}) {
    for (const int frames : {3, 4, 10, 300}) {
      std::vector<Quat> series;
      for (int t = 0; t < frames; ++t) {
        series.push_back(from_rotation_vector(2 * kPi * turns_a_second * t / kRate * axis) *
                         from_rotation_vector(Vec3(0.2, 1, 0)));
      }
      for (const SeriesFilter& filter : both()) {
        EXPECT_LT(largest(filtered(filter, series), series), 1e-10)
            << turns_a_second << " turns, " << frames << " frames";
      }
    }
  }
}

// angle = 0.8 sin(0.3 t) + 0.3 cos(1.9 t), line = linspace(angle[0], angle[-1], 50), sos as in
// series_test.cpp for order 4: sosfiltfilt(sos, angle - line, padlen=30) + line
TEST(SmoothRotations, FilterARotationAboutAFixedAxisAsItsAngle) {
  const Vec3 axis = Vec3(0.3, -1, 0.2).normalized();
  const Quat base = from_rotation_vector(Vec3(2, 0.1, -1));
  std::vector<Quat> series;
  for (int t = 0; t < 50; ++t) {
    const double angle = 0.8 * std::sin(0.3 * t) + 0.3 * std::cos(1.9 * t);
    series.push_back(base * from_rotation_vector(angle * axis));
  }
  const auto result = filtered(butterworth(), series);
  const std::pair<int, double> expected[] = {{0, 0.2999999754205398},   {1, 0.36638738036263035},
                                             {10, 0.11416280907885584}, {25, 0.7341758872257818},
                                             {48, 0.786938393645595},   {49, 0.7997513813104995}};
  for (const auto& [t, angle] : expected) {
    const Vec3 v = rotation_vector(base.conjugate() * result[static_cast<std::size_t>(t)]);
    EXPECT_NEAR(v.dot(axis), angle, 1e-9) << t;
    EXPECT_NEAR((v - v.dot(axis) * axis).norm(), 0, 1e-9) << t;
  }
}

TEST(SmoothRotations, BringNoiseNearerToTheTruthWithoutAShift) {
  const auto truth = tumbling(600);
  const auto noisy = with_noise(truth, 1 * kRadiansPerDegree, 11);
  for (const SeriesFilter& filter : both()) {
    const auto result = filtered(filter, noisy);
    const double error = rms(result, truth);
    EXPECT_LT(error, 0.7 * rms(noisy, truth));
    // Held against the truth of other moments it fits worse the further they are, alike both ways.
    const auto shifted = [&](int by) {
      double sum = 0;
      for (int t = 10; t < 590; ++t) {
        sum += std::pow(angle_between(result[static_cast<std::size_t>(t)],
                                      truth[static_cast<std::size_t>(t + by)]),
                        2);
      }
      return std::sqrt(sum / 580);
    };
    for (const int by : {1, 2, 3}) {
      EXPECT_LT(shifted(0), 0.5 * shifted(by));
      EXPECT_LT(shifted(0), 0.5 * shifted(-by));
      EXPECT_NEAR(shifted(by) / shifted(-by), 1, 0.02);
    }
  }
}

TEST(SmoothRotations, BeatsFilteringTheComponentsWhereJointsMoveFast) {
  const auto truth = tumbling(600);
  auto components = truth;
  for (std::size_t t = 1; t < components.size(); ++t) {
    components[t] = in_hemisphere_of(components[t - 1], components[t]);
  }
  const SeriesFilter filter = butterworth(3);
  std::vector<double> values(truth.size());
  for (int k = 0; k < 4; ++k) {
    for (std::size_t t = 0; t < values.size(); ++t) values[t] = components[t].coeffs()[k];
    filter(values);
    for (std::size_t t = 0; t < values.size(); ++t) components[t].coeffs()[k] = values[t];
  }
  for (Quat& q : components) q.normalize();
  EXPECT_LT(rms(filtered(filter, truth), truth), rms(components, truth));
}

TEST(SmoothRotations, FewFramesStay) {
  for (const int frames : {0, 1, 2}) {
    const auto given = tumbling(frames);
    EXPECT_EQ(largest(filtered(butterworth(), given), given), 0);
  }
}

TEST(SmoothPositions, LeaveEvenMotionAloneAndSmoothTheRest) {
  std::vector<Vec3> even, shaken;
  samples::NoiseSource noise(5);
  for (int t = 0; t < 120; ++t) {
    even.push_back(Vec3(1, 2, 3) + t * Vec3(0.1, -0.02, 0));
    const double x = noise.gaussian(), y = noise.gaussian(), z = noise.gaussian();
    shaken.push_back(even.back() + 0.01 * Vec3(x, y, z));
  }
  for (const SeriesFilter& filter : both()) {
    auto result = even;
    smooth_positions(filter, result);
    for (std::size_t t = 0; t < even.size(); ++t) EXPECT_LT((result[t] - even[t]).norm(), 1e-12);
    result = shaken;
    smooth_positions(filter, result);
    double before = 0, after = 0;
    for (std::size_t t = 0; t < even.size(); ++t) {
      before += (shaken[t] - even[t]).squaredNorm();
      after += (result[t] - even[t]).squaredNorm();
    }
    EXPECT_LT(after, 0.5 * before);
  }
}

}  // namespace
}  // namespace krok::filter
