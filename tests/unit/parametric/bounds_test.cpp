// If these fail, a library promises motions far from any of its examples, or refuses good ones.

#include "parametric/bounds.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace krok::parametric {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

Bounds bounds_of_points(int dimensions, const std::vector<std::vector<double>>& points) {
  Library library;
  library.parameters.resize(static_cast<std::size_t>(dimensions));
  for (const auto& point : points) {
    library.examples.emplace_back();
    library.examples.back().parameters = point;
  }
  return bounds_of(library);
}

TEST(Bounds, InsideIsTheHullAndNotTheBox) {
  // A triangle in units of different size; the box's corner (1, 100) is not in it.
  Bounds bounds = bounds_of_points(2, {{0, 0}, {1, 0}, {0, 100}});
  bounds.margin = 0;
  EXPECT_THAT(bounds.lower, ElementsAre(0, 0));
  EXPECT_THAT(bounds.upper, ElementsAre(1, 100));
  EXPECT_EQ(outside(bounds, std::vector{0.2, 30.0}).distance, 0);
  const Outside corner = outside(bounds, std::vector{1.0, 100.0});
  EXPECT_NEAR(corner.distance, std::sqrt(0.5), 1e-9);
  EXPECT_THAT(corner.nearest, ElementsAre(DoubleNear(0.5, 1e-9), DoubleNear(50, 1e-7)));
  const Outside below = outside(bounds, std::vector{0.5, -25.0});
  EXPECT_NEAR(below.distance, 0.25, 1e-9);
  EXPECT_THAT(below.nearest, ElementsAre(DoubleNear(0.5, 1e-9), DoubleNear(0, 1e-7)));
}

TEST(Bounds, MarginWidensTheHull) {
  const Bounds bounds = bounds_of_points(1, {{2}, {4}});
  EXPECT_EQ(outside(bounds, std::vector{4.039}).distance, 0);
  const Outside off = outside(bounds, std::vector{5.0});
  EXPECT_NEAR(off.distance, 0.5 - 0.02, 1e-12);
  EXPECT_NEAR(off.nearest[0], 4.04, 1e-12);
  // What is given as the nearest is inside.
  EXPECT_EQ(outside(bounds, off.nearest).distance, 0);
}

TEST(Bounds, NearestPointHasThePlaneOfAllExamplesBehindIt) {
  std::mt19937 random(11);
  const auto number = [&] { return static_cast<double>(random() % 10000) / 10000; };
  for (int round = 0; round < 300; ++round) {
    const std::size_t d = 1 + random() % 5, n = 1 + random() % 40;
    std::vector<std::vector<double>> points(n, std::vector<double>(d));
    for (auto& point : points) {
      for (double& value : point) value = number();
    }
    if (round % 3 == 0 && n > 1) points[1] = points[0];  // twice the same
    Bounds bounds = bounds_of_points(static_cast<int>(d), points);
    bounds.margin = 0;
    std::vector<double> asked(d);
    for (double& value : asked) value = 3 * number() - 1;
    const Outside off = outside(bounds, asked);
    std::vector<double> p(d), h(d);
    bounds.scale(asked, p);
    bounds.scale(off.nearest, h);
    double square = 0;
    for (std::size_t i = 0; i < d; ++i) square += (p[i] - h[i]) * (p[i] - h[i]);
    EXPECT_NEAR(std::sqrt(square), off.distance, 1e-7);
    if (off.distance == 0) continue;
    for (std::size_t k = 0; k < n; ++k) {
      double along = 0;
      for (std::size_t i = 0; i < d; ++i)
        along += (bounds.points[k * d + i] - h[i]) * (p[i] - h[i]);
      EXPECT_LT(along, 1e-7) << "round " << round;
    }
  }
}

// A mixture of examples is inside.
TEST(Bounds, MixturesAreInside) {
  std::mt19937 random(12);
  for (int round = 0; round < 100; ++round) {
    const std::size_t d = 1 + random() % 4, n = d + 1 + random() % 20;
    std::vector<std::vector<double>> points(n, std::vector<double>(d));
    std::vector<double> mixture(d, 0);
    double all = 0;
    for (auto& point : points) {
      const double weight = static_cast<double>(random() % 1000);
      all += weight;
      for (std::size_t i = 0; i < d; ++i) {
        point[i] = static_cast<double>(random() % 1000);
        mixture[i] += weight * point[i];
      }
    }
    for (double& value : mixture) value /= all;
    Bounds bounds = bounds_of_points(static_cast<int>(d), points);
    bounds.margin = 1e-6;
    EXPECT_EQ(outside(bounds, mixture).distance, 0);
  }
}

TEST(Bounds, OddNumbersAreOutside) {
  const Bounds bounds = bounds_of_points(2, {{0, 0}, {1, 0}, {0, 1}});
  for (const double odd : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300}) {
    const Outside off = outside(bounds, std::vector{odd, 0.5});
    EXPECT_TRUE(std::isinf(off.distance));
    EXPECT_NEAR(off.nearest[0], 1.0 / 3, 1e-12);
  }
  // One example, or examples that are all alike.
  EXPECT_EQ(outside(bounds_of_points(1, {{2}}), std::vector{2.0}).distance, 0);
  EXPECT_NEAR(outside(bounds_of_points(1, {{2}, {2}}), std::vector{3.0}).distance, 0.98, 1e-12);
}

}  // namespace
}  // namespace krok::parametric
