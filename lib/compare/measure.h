#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "compare/spread.h"
#include "math/types.h"

// How far apart many values of one kind are: the largest difference and where it is, the root of
// the mean square, what 95 % do not exceed, and how many lie over a tolerance.

namespace krok::compare {

// What still counts as the same. A difference equal to the tolerance is within it.
struct Tolerance {
  double length = 1e-5;                     // metres
  double angle = 0.01 * kRadiansPerDegree;  // radians
  double ratio = 1e-4;                      // for what has no unit: weights, texture coordinates
  double time = 1e-4;                       // seconds; times that differ by no more are one
  // Where these are to differ from the former.
  std::optional<double> normals = {};             // radians; of tangents too
  std::optional<double> joint_positions = {};     // metres
  std::optional<double> joint_orientations = {};  // radians

  double of_normals() const { return normals.value_or(angle); }
  double of_joint_positions() const { return joint_positions.value_or(length); }
  double of_joint_orientations() const { return joint_orientations.value_or(angle); }
};

// Where a value is; -1 for what does not apply.
struct ValueLocation {
  int mesh = -1;
  int vertex = -1;
  int joint = -1;
  int target = -1;     // morph target
  int animation = -1;  // among several
  int frame = -1;
  double time = 0;         // seconds, where frame is given
  bool in_second = false;  // mesh and vertex are the second's, not the first's
};

// Differences of one quantity, gathered one by one. Adding in the same order gives the same bits;
// the place of the largest is that of the first of equal ones.
struct Totals {
  double tolerance = 0;
  double largest = 0;
  ValueLocation where;  // of the largest; meaningful if largest > 0
  double square_sum = 0;
  std::int64_t count = 0;  // how many values were compared
  std::int64_t over = 0;   // how many of them differ by more than the tolerance

  Totals() = default;
  explicit Totals(double allowed) : tolerance(allowed) {}

  // `difference` >= 0. One that is not a number counts as infinite.
  void add(double difference, const ValueLocation& place) {
    difference = finite_or_infinite(difference);
    if (difference > largest) {
      largest = difference;
      where = place;
    }
    square_sum += difference * difference;
    over += difference > tolerance ? 1 : 0;
    ++count;
  }

  // Adds what others with the same tolerance have gathered, as if it came after.
  void merge(const Totals& later);

  double rms() const;
  bool within() const { return over == 0; }

  static double finite_or_infinite(double difference) {
    return difference <= std::numeric_limits<double>::max()
               ? difference
               : std::numeric_limits<double>::infinity();
  }
};

// The same with percentiles.
struct Measure : Totals {
  Spread spread;

  Measure() = default;
  explicit Measure(double allowed) : Totals(allowed) {}

  void add(double difference, const ValueLocation& place) {
    Totals::add(difference, place);
    spread.add(finite_or_infinite(difference));
  }
  void merge(const Measure& later);

  // What a share of all, in (0, 1], do not exceed; see Spread, but never more than the largest.
  double percentile(double share) const;
};

// How one joint differs.
struct JointDifference {
  int joint = -1;        // of the first
  Measure positions;     // metres
  Measure orientations;  // radians
};

// The angle between two directions in [0, pi], accurate near 0 and pi. 0 if both vanish, pi if one
// does.
double angle_between_directions(const Vec3& a, const Vec3& b);

// The same, quicker, for directions that are of unit length or vanish.
inline double angle_between_units(const Vec3& a, const Vec3& b) {
  constexpr double kNear = 1e-4;  // squared length of a chord
  constexpr double kUnit = 0.5;   // squared length; less vanishes
  const double square = (a - b).squaredNorm();
  if (!(square < kNear) || a.squaredNorm() < kUnit) return angle_between_directions(a, b);
  // angle = 2 asin(chord / 2); what the series leaves out is less than 1e-17 of it.
  return std::sqrt(square) * (1 + square * (1.0 / 24 + square * (3.0 / 640 + square * 5.0 / 7168)));
}

}  // namespace krok::compare
