#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "parametric/library.h"
#include "pose/packed_pose.h"

namespace krok::parametric {

// The examples of a library made ready for blending, once. Generic time is that of the average
// example: 0 at the first keytime, at each other one the mean of the examples' seconds. (Counting
// keytimes, 0, 1, 2, would do as well if intervals were of like length; where a short one meets a
// long one the cubic through them comes to rest at an end, and blends begin with a jerk.)
struct PackedExamples {
  std::vector<PackedClip> clips;  // [examples]
  std::vector<double> generic;    // [keytimes], of the keytimes, rising from 0
  // Each example's time by generic time is a monotone cubic (PCHIP) through its keytimes: seconds
  // at them, and seconds for one of generic time. [keytimes x examples]
  Eigen::MatrixXd times, slopes;
  // The mean of all examples by generic time: the hemisphere that rotations are summed in.
  PackedClip reference;
  // [joints], 1 where a joint carries a bone longer than a hundredth of the figure's extent.
  std::vector<std::uint8_t> carries;

  int examples() const { return static_cast<int>(clips.size()); }
  int keytimes() const { return static_cast<int>(times.rows()); }
};

// The library must hold, with one example or more.
PackedExamples pack_examples(const Library& library);

// A place within generic time: the interval, and what values and slopes at its ends count there.
struct GenericTimePoint {
  int interval = 0;
  double value[2] = {1, 0}, slope[2] = {0, 0};
};

// `generic` is brought between the first keytime and the last.
GenericTimePoint generic_place(std::span<const double> knots, double generic);

// Seconds in the example's motion.
inline double example_time(const PackedExamples& packed, const GenericTimePoint& place,
                           int example) {
  const int k = place.interval;
  return place.value[0] * packed.times(k, example) + place.slope[0] * packed.slopes(k, example) +
         place.value[1] * packed.times(k + 1, example) +
         place.slope[1] * packed.slopes(k + 1, example);
}

// How far apart examples are: the largest angle between the rotations to the parent of one joint in
// two of them, at the same generic time. Over 90 degrees a weighted sum means little. Joints that
// carry nothing, such as eyes, do not count: captures leave them anywhere.
struct Spread {
  double angle = 0;                      // radians
  int joint = 0, first = 0, second = 0;  // the two examples
  double generic = 0;
};
Spread widest_spread(const PackedExamples& packed);

}  // namespace krok::parametric
