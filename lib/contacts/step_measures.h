#pragma once

#include <array>
#include <optional>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

namespace krok {

// Spatial gait measures, metres on the ground plane; medians over the clip, empty if there is no
// such step. Lengths are along the line between two successive places of the other foot, width is
// across it, as usual in gait analysis (Whittle, "Gait Analysis", 2007), with the ankle as the
// foot's point.
struct StepMeasures {
  int steps = 0;                        // of both feet
  std::optional<double> speed;          // metres per second, stride length over its time
  std::optional<double> stride_length;  // between two places of one foot
  std::array<std::optional<double>, 2> step_length;  // left, right: ahead of the other foot
  std::optional<double> step_width;                  // negative if the feet cross the middle
  // The share of strides that go on like the one before, of the other foot, and take the hips
  // along: nearly all of a walk or run, few of a dance or a fight.
  std::optional<double> steadiness;

  // Whether it is a walk or a run: two strides in a row that go on at 0.3 metres per second or
  // more.
  bool are_gait() const {
    constexpr double kMinSpeed = 0.3;  // metres per second
    return steadiness.has_value() && speed.value_or(0) >= kMinSpeed && are_steady();
  }

  // Steps that go to and fro are no gait. Of steps on the spot, or of one alone, it cannot be
  // known.
  bool are_steady() const {
    constexpr double kOnTheSpot = 0.2, kMinSteadiness = 0.5;  // metres; share
    return stride_length.value_or(0) < kOnTheSpot || steadiness.value_or(1) >= kMinSteadiness;
  }
};

// A foot's place is the mean position of its ankle in the middle third of a stance, which is from a
// strike to the toe-off after it. Where whole stances give no step of a foot, those that the clip
// cuts off count, too, if their middle third is within it. A step is three places in turn (left,
// right, left, ..), each within three seconds of the next and without a jump of the hips between.
StepMeasures step_measures(const Clip& clip, const RoleMap& roles,
                           const std::vector<Keytime>& keytimes);

}  // namespace krok
