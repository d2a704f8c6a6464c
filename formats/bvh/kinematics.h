#pragma once

#include <span>
#include <vector>

#include "capture/convention_choice.h"
#include "formats/bvh/hierarchy.h"
#include "math/transform.h"

namespace krok::bvh {

// The joints of a file with their offsets and channels converted once, so that a row of numbers
// becomes a pose without further conversion. All of a joint turns with the axes of the reference
// pose; where the motion's are others, the root carries the whole figure over.
class Kinematics {
 public:
  // `positions` is absolute or additive.
  Kinematics(const Hierarchy& hierarchy, Positions positions, const Conversion& conversion);

  std::size_t joint_count() const { return parents_.size(); }
  std::span<const int> parents() const { return parents_; }

  // joint_to_world, shape [joints], from a row's values, shape [channels], in doubles.
  void pose(std::span<const double> values, std::span<Transform> joint_to_world) const;

  // joint_to_world with the OFFSETs and zero rotations.
  std::vector<Transform> reference() const;

 private:
  struct Step {
    std::size_t channel;
    ChannelKind kind;
    Axis axis;      // Krok's
    double factor;  // to metres or radians, with the axis's sign
  };
  std::vector<int> parents_;
  std::vector<Vec3> offsets_;  // metres, Krok's axes
  std::vector<Vec3> base_;     // the offset's part that position channels leave
  Transform reference_to_motion_;
  std::vector<Step> steps_;               // joint by joint
  std::vector<std::size_t> step_begins_;  // [joints + 1]
};

}  // namespace krok::bvh
