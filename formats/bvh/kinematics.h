#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "capture/convention_choice.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/kinematics_kernel.h"
#include "math/transform.h"

namespace krok::bvh {

// The joints of a file with offsets and channels converted to Krok's axes and units once, so that a
// row becomes a pose without further conversion. Joint frames use the axes of the reference pose;
// if the motion has different axes, the root carries the rotation between the two.
class Kinematics {
 public:
  static constexpr std::size_t kFramesAtOnce = kinematics_detail::kFramesAtOnce;

  // `positions` is absolute or additive.
  Kinematics(const Hierarchy& hierarchy, Positions positions, const Conversion& conversion);

  std::size_t joint_count() const { return parents_.size(); }
  std::span<const int> parents() const { return parents_; }

  // joint_to_world, shape [joints], from the values of a row, shape [channels], in doubles.
  void pose(std::span<const double> values, std::span<Transform> joint_to_world) const;

  // The same for up to kFramesAtOnce frames, vectorised over frames; bit-identical to pose()
  // rounded to floats. `values` has shape [channels x kFramesAtOnce], 64-byte aligned (values of
  // unused frames must be finite); the results have shape [frames x joints]. `scratch` is resized
  // as needed and can be reused. Returns false if a position may exceed farthest() (or is infinite)
  // or a rotation exceeds kFarthestRotation.
  bool poses(std::span<const double> values, std::size_t frames, std::vector<double>& scratch,
             std::span<Vec3f> positions, std::span<Quatf> orientations) const;

  // Limit beyond which positions are reported, in metres.
  double farthest() const { return farthest_; }

  // Lowers that limit for a motion within `usual_distance` (capture/far_values.h).
  void expect_within(double usual_distance);
  double usual_distance() const { return usual_distance_; }

  // The first channel with a rotation beyond kFarthestRotation in a row, whose values are `stride`
  // apart, and its absolute value in degrees.
  struct Rotation {
    std::size_t channel = 0;
    double degrees = 0;
  };
  std::optional<Rotation> far_rotation(const double* values, std::size_t stride) const;

  // joint_to_world with the OFFSETs and zero rotations.
  std::vector<Transform> reference() const;

 private:
  kinematics_detail::Job job(double* scratch) const;

  // Converts the values of a file in radians, `stride` frames per channel.
  void put_in_degrees(std::span<double> values, std::size_t stride) const;

  std::vector<int> parents_;
  std::vector<Vec3> offsets_;  // metres, Krok's axes
  std::vector<Vec3> base_;     // the part of the offset not replaced by position channels
  Transform reference_to_motion_;
  double degrees_per_angle_ = 1.0;
  double farthest_ = 0;
  double usual_distance_ = INFINITY;
  std::vector<kinematics_detail::Step> steps_;  // joint by joint
  std::vector<std::size_t> step_begins_;        // [joints + 1]
};

}  // namespace krok::bvh
