#pragma once

#include <utility>
#include <vector>

#include "lint/lint.h"

// What the rules of one motion share.

namespace krok::lint {

// Frames of a finding, inclusive, and the one at which it shows best.
struct Span {
  int first = 0, last = 0, worst = 0;
};

// A motion as the rules look at it.
struct Series {
  const Clip& clip;
  const RoleMap& roles;
  const MotionOptions& options;
  int joints = 0, frames = 0;
  double rate = 30;
  double scale = 1;  // legs as a multiple of 0.86 m; 1 if they are not known
  int carrier = 0;   // carrying_joint()

  std::vector<float> largest;  // [joints], squares of the largest turns
  std::vector<Vec3f> steps;    // [frames] of the carrier, metres; the first is zero
  std::vector<float> moved;    // [frames], the largest turn (rad) or step (m) of all joints

  Series(const Clip& clip, const RoleMap& roles, const MotionOptions& options);
  // Rotation of a joint in its parent (the root's in the world) from the frame before, radians:
  // twice the vector part of its quaternion, [frames]; the first is zero.
  std::vector<Vec3f> turns_of(int joint) const;
  int frames_in(double seconds, int at_least) const;
  Span whole() const { return {0, frames > 0 ? frames - 1 : 0, 0}; }
  // The hips' mean acceleration downwards, metres per second squared of legs of 0.86 m; `all`: that
  // of the mean of all joints.
  double fall(int first, int last, bool all = false) const;

  bool has(Rule rule) const { return options.settings.has(rule); }
  double threshold(Rule rule) const { return options.settings.threshold(rule); }
};

// Radians or metres a frame, more than rounding leaves of a pose that is held.
inline constexpr float kStill = 2e-5F;

// With the rule's limit and unit; limits in metres scale with the legs.
Finding finding_of(Rule rule, const Series& series, double value, const Span& span);

// The runs [first, end) of frames of which something is so.
template <class Is>
std::vector<std::pair<int, int>> runs_of(int frames, const Is& is) {
  std::vector<std::pair<int, int>> runs;
  for (int f = 0; f < frames; ++f) {
    if (!is(f)) continue;
    if (runs.empty() || runs.back().second < f) runs.emplace_back(f, f);
    runs.back().second = f + 1;
  }
  return runs;
}

// One finding for all joints with the same fault at the same time: of findings of one rule and kind
// that overlap in time (or are `near` frames apart) the worst stays and counts the others' joints.
void merge_joints(std::vector<Finding>& findings, int near);

void find_rotation_faults(const Series& series, MotionFaults& out);  // pop, flip
void find_noise_faults(const Series& series, MotionFaults& out);     // jitter, over-smooth, frozen
void find_foot_faults(const Series& series, MotionFaults& out);      // foot-slide, drift, ground
void find_body_faults(const Series& series, MotionFaults& out);      // bones, limits, poses, unit
void find_rate_faults(const Series& series, MotionFaults& out);  // doubled frames, swings, falls

}  // namespace krok::lint
