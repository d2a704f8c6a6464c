#pragma once

#include <optional>
#include <span>
#include <vector>

#include "capture/convention_choice.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/kinematics_kernel.h"
#include "math/transform.h"

namespace krok::bvh {

// The joints of a file with their offsets and channels converted once, so that a row of numbers
// becomes a pose without further conversion. All of a joint turns with the axes of the reference
// pose; where the motion's are others, the root carries the whole figure over.
class Kinematics {
 public:
  static constexpr std::size_t kFramesAtOnce = kinematics_detail::kFramesAtOnce;

  // `positions` is absolute or additive.
  Kinematics(const Hierarchy& hierarchy, Positions positions, const Conversion& conversion);

  std::size_t joint_count() const { return parents_.size(); }
  std::span<const int> parents() const { return parents_; }

  // joint_to_world, shape [joints], from a row's values, shape [channels], in doubles.
  void pose(std::span<const double> values, std::span<Transform> joint_to_world) const;

  // The same for up to kFramesAtOnce frames at a time as floats, vectorised over the frames: the
  // bits are those of pose(), rounded. `values` has [channels x kFramesAtOnce] doubles on a 64-byte
  // boundary (what stands in the places of frames that are not asked for must be finite), the
  // results shape [frames x joints]; `scratch` is resized as needed, and may serve again. False if
  // some position may be farther than farthest(), infinite perhaps, or some rotation than
  // kFarthestRotation.
  bool poses(std::span<const double> values, std::size_t frames, std::vector<double>& scratch,
             std::span<Vec3f> positions, std::span<Quatf> orientations) const;

  // Beyond which positions are told of, in metres.
  double farthest() const { return farthest_; }

  // The first channel with a rotation beyond kFarthestRotation in a row whose values stand `stride`
  // apart, and its size in degrees.
  struct Rotation {
    std::size_t channel = 0;
    double degrees = 0;
  };
  std::optional<Rotation> far_rotation(const double* values, std::size_t stride) const;

  // joint_to_world with the OFFSETs and zero rotations.
  std::vector<Transform> reference() const;

 private:
  kinematics_detail::Job job(double* scratch) const;

  // Files in radians are rare; their values are converted here, `stride` frames a channel.
  void put_in_degrees(std::span<double> values, std::size_t stride) const;

  std::vector<int> parents_;
  std::vector<Vec3> offsets_;  // metres, Krok's axes
  std::vector<Vec3> base_;     // the offset's part that position channels leave
  Transform reference_to_motion_;
  double degrees_per_angle_ = 1.0;
  double farthest_ = 0;
  std::vector<kinematics_detail::Step> steps_;  // joint by joint
  std::vector<std::size_t> step_begins_;        // [joints + 1]
};

}  // namespace krok::bvh
