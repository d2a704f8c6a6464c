#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "motion/hips_root.h"
#include "parametric/library.h"
#include "pose/packed_pose.h"

namespace krok::parametric {

// A library's examples prepared for blending. Generic time is that of the average example: 0 at the
// first keytime, and at each other one the mean of the examples' times, seconds. (Numbering
// keytimes 0, 1, 2 works only if intervals have similar length; otherwise the cubic comes to rest
// at the end of a short interval, and blends start with a jerk.)
//
// Poses are those of HipsRoot::rooted(): a step's root stands wherever the walk left it, which says
// nothing about the step.
struct PackedExamples {
  HipsRoot hips_root;
  Skeleton skeleton;              // of the poses: the library's joints, and those appended
  std::vector<PackedClip> clips;  // [examples]
  std::vector<double> generic;    // [keytimes], generic time of the keytimes, rising from 0
  // Each example's time by generic time is a monotone cubic (PCHIP) through its keytimes: values
  // (seconds) and derivatives at them. [keytimes x examples]
  Eigen::MatrixXd times, slopes;
  // Mean of all examples by generic time; rotations are summed in its hemisphere.
  PackedClip reference;
  // [joints of the poses], 1 if the joint carries a bone longer than a hundredth of the skeleton's
  // extent.
  std::vector<std::uint8_t> carries;

  int examples() const { return static_cast<int>(clips.size()); }
  int keytimes() const { return static_cast<int>(times.rows()); }
};

// The library must be valid, with at least one example.
PackedExamples pack_examples(const Library& library);

// A point in generic time: its interval, and the Hermite basis values for the values and slopes at
// the interval's ends.
struct GenericTimePoint {
  int interval = 0;
  double value[2] = {1, 0}, slope[2] = {0, 0};
};

// `generic` is clamped to the keytimes.
GenericTimePoint generic_place(std::span<const double> knots, double generic);

// Time in the example's motion, seconds.
inline double example_time(const PackedExamples& packed, const GenericTimePoint& place,
                           int example) {
  const int k = place.interval;
  return place.value[0] * packed.times(k, example) + place.slope[0] * packed.slopes(k, example) +
         place.value[1] * packed.times(k + 1, example) +
         place.slope[1] * packed.slopes(k + 1, example);
}

// Largest difference between examples: the angle between the local rotations of one joint in two
// examples at the same generic time. Beyond 90 degrees a weighted sum of rotations is unreliable.
// Joints that carry nothing, such as eyes, are ignored: captures leave them in arbitrary poses.
struct Spread {
  double angle = 0;                      // radians
  int joint = 0, first = 0, second = 0;  // the two examples
  double generic = 0;
};
Spread widest_spread(const PackedExamples& packed);

}  // namespace krok::parametric
