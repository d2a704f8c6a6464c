// If these fail, orientations in Krok's files are less accurate than the format promises, or a file
// changes when it is read and written again.

#include "formats/container/packed_orientation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "math/quaternion.h"

namespace krok {
namespace {

// Rotations evenly over all orientations, the same ones on every machine; with `w` given, over
// those with that w.
class RandomRotations {
 public:
  Quat next() {
    Quat q(normal(), normal(), normal(), normal());
    return q.normalized();
  }
  Quat next_with_w(double w) {
    const Vec3 axis = Vec3(normal(), normal(), normal()).normalized();
    const Vec3 v = axis * std::sqrt(1 - w * w);
    return Quat(w, v.x(), v.y(), v.z());
  }

 private:
  // Sum of twelve uniform values: near enough to normal, and the same with every standard library.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(engine_() >> 11) * 0x1p-53;
    return sum;
  }
  std::mt19937_64 engine_{20240229};
};

std::array<float, 3> pack_by_rounding(const Quat& q) {
  const Vec3 v = q.w() > 0 ? Vec3(-q.vec()) : Vec3(q.vec());
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

struct Errors {
  double median, largest;
};

Errors errors_of(std::vector<double> angles) {
  std::sort(angles.begin(), angles.end());
  return {angles[angles.size() / 2], angles.back()};
}

struct Comparison {
  Errors rounded, searched;
};

template <typename Next>
Comparison compare(const std::string& what, Next next) {
  std::vector<double> rounded, searched;
  for (int i = 0; i < 20000; ++i) {
    const Quat q = next();
    rounded.push_back(angle_between(unpack_orientation(pack_by_rounding(q)), q));
    searched.push_back(angle_between(unpack_orientation(pack_orientation(q)), q));
  }
  const Comparison result = {errors_of(rounded), errors_of(searched)};
  std::printf("%-18s rounded: median %.2e, max %.2e rad; searched: median %.2e, max %.2e rad\n",
              what.c_str(), result.rounded.median, result.rounded.largest, result.searched.median,
              result.searched.largest);
  return result;
}

TEST(PackedOrientation, RandomRotationsComeBackWithinFloatRounding) {
  RandomRotations random;
  const auto result = compare("random", [&] { return random.next(); });
  EXPECT_LE(result.searched.median, result.rounded.median);
  EXPECT_LT(result.searched.median, 7e-8);
  EXPECT_LT(result.searched.largest, 1e-5);
}

// The median falls to a tenth and less. The largest error stays where all triples of floats give
// nearly the same sums: axes near (1, 1, 1), (1, 1, 0) and (1, 0, 0).
TEST(PackedOrientation, SearchPaysWhereWIsSmall) {
  for (const double w : {0.1, 0.01, 1e-3, 1e-4, 1e-5, 0.0}) {
    RandomRotations random;
    const std::string what = "|w| = " + shortest(w);
    const auto result = compare(what, [&] { return random.next_with_w(w); });
    EXPECT_LE(result.searched.median, result.rounded.median) << what;
    EXPECT_LE(result.searched.largest, result.rounded.largest) << what;
    if (w == 0.01 || w == 1e-3 || w == 1e-4 || w == 1e-5) {
      EXPECT_LT(result.searched.median, result.rounded.median / 10) << what;
      EXPECT_LT(result.searched.largest, result.rounded.largest / 2) << what;
    }
  }
}

TEST(PackedOrientation, ErrorBoundHoldsAnywhere) {
  RandomRotations random;
  double largest = 0;
  for (int i = 0; i < 20000; ++i) {
    const Quat q = random.next_with_w(std::pow(10.0, -8.0 * i / 20000));
    largest = std::max(largest, angle_between(unpack_orientation(pack_orientation(q)), q));
  }
  EXPECT_LT(largest, 4e-4);
}

TEST(PackedOrientation, WIsNeverPositiveAndRotationsKeepTheirMeaning) {
  RandomRotations random;
  for (int i = 0; i < 1000; ++i) {
    const Quat q = random.next();
    const Quat back = unpack_orientation(pack_orientation(q));
    EXPECT_LE(back.w(), 0);
    EXPECT_NEAR(back.norm(), 1, 1e-6);
    const Quat negated(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_EQ(pack_orientation(q), pack_orientation(negated)) << "q and -q are one rotation";
  }
}

TEST(PackedOrientation, WhatWasUnpackedPacksToTheSameFloats) {
  RandomRotations random;
  for (int i = 0; i < 20000; ++i) {
    const Quat q = i % 2 == 0 ? random.next() : random.next_with_w(std::pow(10.0, -(i % 8)));
    const auto packed = pack_orientation(q);
    const Quat back = unpack_orientation(packed);
    EXPECT_EQ(pack_orientation(back), packed);
    EXPECT_EQ(pack_orientation(back.cast<float>().cast<double>()), packed);
  }
}

TEST(PackedOrientation, ExactCasesStayExact) {
  EXPECT_EQ(pack_orientation(Quat::Identity()), (std::array<float, 3>{0, 0, 0}));
  EXPECT_EQ(pack_orientation(Quat(-1, 0, 0, 0)), (std::array<float, 3>{0, 0, 0}));
  EXPECT_EQ(pack_orientation(Quat(0, 0, 1, 0)), (std::array<float, 3>{0, 1, 0}));
  EXPECT_EQ(pack_orientation(Quat(0, 0, 0, -1)), (std::array<float, 3>{0, 0, -1}));
  for (const float value : pack_orientation(Quat::Identity())) EXPECT_FALSE(std::signbit(value));
  const Quat identity = unpack_orientation({0, 0, 0});
  EXPECT_EQ(identity.w(), -1);
}

TEST(PackedOrientation, DegenerateInputGivesTheIdentity) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(pack_orientation(Quat(0, 0, 0, 0)), (std::array<float, 3>{0, 0, 0}));
  EXPECT_EQ(pack_orientation(Quat(nan, nan, nan, nan)), (std::array<float, 3>{0, 0, 0}));
}

TEST(PackedOrientation, UnnormalisedInputIsNormalised) {
  const Quat q = Quat(-0.5, 0.5, 0.5, 0.5);
  const Quat longer(-0.5002, 0.5002, 0.5002, 0.5002);
  EXPECT_LT(angle_between(unpack_orientation(pack_orientation(longer)), q), 3e-7);
}

// The rule of the format as it is printed in the specification.
TEST(PackedOrientation, UnpackingIsTheFormula) {
  const Quat q = unpack_orientation({0.6f, 0.0f, 0.0f});
  const double x{0.6f};
  EXPECT_EQ(q.w(), -std::sqrt(1 - x * x));
  EXPECT_EQ(unpack_orientation({1.0f, 0.001f, 0.0f}).w(), 0) << "too long: w is 0";
}

}  // namespace
}  // namespace krok
