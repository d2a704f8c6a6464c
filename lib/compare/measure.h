#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "math/transform.h"

// Streaming percentiles of a distribution in bounded memory.

namespace krok::compare {

// Up to kExact nonzero values are kept exactly; beyond that they are counted in bins, 64 per
// octave. Results depend only on the values, not on their order or on how they were split before
// merging.
class Spread {
 public:
  static constexpr std::size_t kExact = 256;

  // `value` >= 0; infinity is allowed.
  void add(double value) {
    const std::uint64_t bin = bin_of(value) - first_bin_;
    if (value == 0) {
      ++zeros_;
    } else if (bin < bins_.size()) {
      ++bins_[bin];
      ++positive_;
    } else {
      add_positive(value);
    }
  }
  void merge(const Spread& other);

  std::int64_t count() const { return zeros_ + positive_; }

  // The smallest value that a fraction `share`, in (0, 1], of all do not exceed (nearest rank); 0
  // without values. Exact for up to kExact nonzero values, otherwise at most 1.6 % too high, never
  // too low. Values under 1e-19 count as 1e-19, values over 1e19 as infinity.
  double percentile(double share) const;

 private:
  // Bin index: exponent and first mantissa bits, rising with the value. Taken from the bits, so
  // that it is the same on every machine.
  static std::uint64_t bin_of(double value) { return std::bit_cast<std::uint64_t>(value) >> 46; }

  void add_positive(double value);
  void empty_few();
  void count_in_bins(double value);
  void make_room(std::uint64_t bin);

  std::int64_t zeros_ = 0;
  std::int64_t positive_ = 0;
  std::int64_t beyond_ = 0;         // above the bins
  std::vector<double> few_;         // exact values, while there are few
  std::uint64_t first_bin_ = 0;     // index of bins_[0]
  std::vector<std::int64_t> bins_;  // only the octaves between those that occur
};

// Statistics of the differences between many values of one kind: max and its location, RMS,
// percentiles, and how many exceed a tolerance.

// Max accepted differences. A difference equal to the tolerance is within it.
struct Tolerance {
  double length = 1e-5;                     // metres
  double angle = 0.01 * kRadiansPerDegree;  // radians
  double ratio = 1e-4;  // for values without a unit: weights, texture coordinates
  double time = 1e-4;   // seconds; times that differ by no more are equal
  // Override `angle` or `length` if set.
  std::optional<double> normals = {};             // radians; also for tangents
  std::optional<double> joint_positions = {};     // metres
  std::optional<double> joint_orientations = {};  // radians

  double of_normals() const { return normals.value_or(angle); }
  double of_joint_positions() const { return joint_positions.value_or(length); }
  double of_joint_orientations() const { return joint_orientations.value_or(angle); }
};

// Location of a value; -1 for fields that do not apply.
struct ValueLocation {
  int mesh = -1;
  int vertex = -1;
  int joint = -1;
  int target = -1;     // morph target
  int animation = -1;  // among several
  int frame = -1;
  bool after_frame = false;  // the time is between that frame and the next
  double time = 0;           // seconds, if frame is set
  bool in_second = false;    // mesh and vertex are in the second, not the first
};

// Accumulates differences of one quantity. Adding in the same order is bit-reproducible; of equal
// maxima, the first gives the location; of joints also if they are equal but for rounding: what
// hangs on a joint that was turned is turned as far.
struct Totals {
  double tolerance = 0;
  double largest = 0;
  ValueLocation where;  // of the largest; valid if largest > 0
  double sum = 0, square_sum = 0;
  std::int64_t count = 0;  // number of values compared
  std::int64_t over = 0;   // number of differences above the tolerance

  Totals() = default;
  explicit Totals(double allowed) : tolerance(allowed) {}

  // `difference` >= 0. NaN counts as infinity.
  void add(double difference, const ValueLocation& place) {
    difference = finite_or_infinite(difference);
    take_largest(difference, place);
    sum += difference;
    square_sum += difference * difference;
    over += difference > tolerance ? 1 : 0;
    ++count;
  }

  // Adds the totals of later values, with the same tolerance.
  void merge(const Totals& later);

  double mean() const { return count == 0 ? 0.0 : sum / static_cast<double>(count); }
  double rms() const;
  bool within() const { return over == 0; }

  void take_largest(double difference, const ValueLocation& place) {
    if (!(difference > largest)) return;
    constexpr double kRounding = 1e-4;
    const bool hangs_on_it = largest > 0 && where.joint >= 0 && place.joint > where.joint &&
                             difference <= (1 + kRounding) * largest;
    largest = difference;
    if (!hangs_on_it) where = place;
  }

  static double finite_or_infinite(double difference) {
    return difference <= std::numeric_limits<double>::max()
               ? difference
               : std::numeric_limits<double>::infinity();
  }
};

// Totals with percentiles.
struct Measure : Totals {
  Spread spread;

  Measure() = default;
  explicit Measure(double allowed) : Totals(allowed) {}

  void add(double difference, const ValueLocation& place) {
    Totals::add(difference, place);
    spread.add(finite_or_infinite(difference));
  }
  void merge(const Measure& later);

  // The value that a fraction `share`, in (0, 1], of all do not exceed; see Spread. Never above the
  // largest.
  double percentile(double share) const;
};

// Differences of one joint.
struct JointDifference {
  int joint = -1;        // of the first
  Measure positions;     // metres
  Measure orientations;  // radians
};

// The angle between two directions in [0, pi], accurate near 0 and pi. 0 if both are zero, pi if
// only one is.
double angle_between_directions(const Vec3& a, const Vec3& b);

// The same, faster, for directions that are unit length or zero.
inline double angle_between_units(const Vec3& a, const Vec3& b) {
  constexpr double kNear = 1e-4;  // squared chord length
  constexpr double kUnit = 0.5;   // squared length; below it is zero
  const double square = (a - b).squaredNorm();
  if (!(square < kNear) || a.squaredNorm() < kUnit) return angle_between_directions(a, b);
  // angle = 2 asin(chord / 2); the truncated series has a relative error below 1e-17.
  return std::sqrt(square) * (1 + square * (1.0 / 24 + square * (3.0 / 640 + square * 5.0 / 7168)));
}

}  // namespace krok::compare
