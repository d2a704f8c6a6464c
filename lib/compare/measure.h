#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "math/types.h"

// How far apart many values of one kind are: the largest difference and where it is, the root of
// the mean square, and how many lie over a tolerance.

namespace krok::compare {

// What still counts as the same. A difference equal to the tolerance is within it.
struct Tolerance {
  double length = 1e-5;                     // metres
  double angle = 0.01 * kRadiansPerDegree;  // radians
  double ratio = 1e-4;                      // for what has no unit: weights, texture coordinates
};

// Where a value is; -1 for what does not apply.
struct Place {
  int mesh = -1;
  int vertex = -1;
  int joint = -1;
  int target = -1;     // morph target
  int animation = -1;  // among several
  int frame = -1;
  double time = 0;  // seconds, where frame is given
};

// Differences of one quantity, gathered one by one. Adding in the same order gives the same bits;
// the place of the largest is that of the first of equal ones.
struct Measure {
  double tolerance = 0;
  double largest = 0;
  Place where;  // of the largest; meaningful if largest > 0
  double square_sum = 0;
  std::int64_t count = 0;  // how many values were compared
  std::int64_t over = 0;   // how many of them differ by more than the tolerance

  Measure() = default;
  explicit Measure(double allowed) : tolerance(allowed) {}

  // `difference` >= 0. One that is not a number counts as infinite.
  void add(double difference, const Place& place) {
    if (!(difference <= std::numeric_limits<double>::max())) {
      difference = std::numeric_limits<double>::infinity();
    }
    if (difference > largest) {
      largest = difference;
      where = place;
    }
    square_sum += difference * difference;
    over += difference > tolerance ? 1 : 0;
    ++count;
  }

  // Adds what another one with the same tolerance has gathered, as if it came after.
  void merge(const Measure& later);

  double rms() const;
  bool within() const { return over == 0; }
};

// The angle between two directions in [0, pi], accurate near 0 and pi. 0 if both vanish, pi if one
// does.
double angle_between_directions(const Vec3& a, const Vec3& b);

}  // namespace krok::compare
