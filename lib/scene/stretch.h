#pragma once

#include <span>
#include <vector>

#include "scene/clip.h"

namespace krok {

// The part of a joint's transform that is not rigid: the symmetric matrix U of its polar
// decomposition, in the joint's own frame (in continuum mechanics the right stretch tensor).
// joint_to_world is [R U | p] with the orientation R and the position p of a Clip. The identity for
// a rigid joint, negative definite for a mirrored one, singular for a flattened one. In the
// reference pose all joints are rigid: what a bind pose scales is part of the mesh.
struct Stretch {
  float xx = 1, yy = 1, zz = 1, xy = 0, xz = 0, yz = 0;

  static Stretch of(const Mat3& symmetric);  // rounded to floats
  Mat3 matrix() const;
  bool operator==(const Stretch&) const = default;
};

// The stretches of a clip's joints, [frames x joints], or none if all are rigid. They are kept
// beside the Clip: an operation that takes a clip alone works on rigid joints, and whoever reads a
// motion for it has to decide about them (io::open_motion warns).
using Stretches = std::vector<Stretch>;

// Checks that there is none or one per joint and frame, all finite. Codes: stretch-shape,
// stretch-value.
Status check(std::span<const Stretch> stretches, const Clip& clip);

// The largest relative change of an axis, |U e - e|, over all; size 0 if there are none.
struct LargestStretch {
  double size = 0;
  int joint = 0, frame = 0;
};
LargestStretch largest_stretch(std::span<const Stretch> stretches, int joints);

// [R U | p].
Mat4 joint_to_world(const Transform& rigid, const Stretch& stretch);

// Those of every `step`-th frame of [first, last], as cut() of lib/motion; none for none.
Stretches cut(std::span<const Stretch> stretches, int joints, int first, int last, int step = 1);

// Those of a moment between frames, interpolated linearly: `place` in frames, clamped; [joints].
// `stretches` must not be empty.
void sample(std::span<const Stretch> stretches, double place, std::span<Stretch> joints);

}  // namespace krok
