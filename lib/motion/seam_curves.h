#pragma once

#include <array>

#include "math/transform.h"

// What is missing where one piece of motion goes over into another, and the curves that bring both
// there. Rates are per frame. Used by loop().

namespace krok {

// One joint's transforms on both sides, from the seam outwards: before[0] and after[0] stand at the
// same moment, the others one and two frames away.
struct SeamSides {
  std::array<Transform, 3> before, after;
};

struct SeamGap {
  Vec3 value = Vec3::Zero();  // from the end to the beginning; a rotation vector in the end's frame
  // Velocities at the seam; for rotations each in its own side's frame. From parabolas of equal
  // curvature through the frames of both sides: a bend is not taken for a jump of velocity.
  Vec3 rate_before = Vec3::Zero(), rate_after = Vec3::Zero();

  double jump() const { return (rate_after - rate_before).norm(); }

  // Leaves of the jump only what is more than `usual`.
  void forgive(double usual);
};

SeamGap rotation_gap(const SeamSides& sides);
SeamGap position_gap(const SeamSides& sides);

// What is added on each side, a quintic Hermite curve in each coordinate: half the gap at the seam,
// zero with two derivatives `width` frames away.
class SeamCurve {
 public:
  SeamCurve(const Vec3& value_before, const Vec3& slope_before, const Vec3& value_after,
            const Vec3& slope_after, int width);

  // `from_seam` frames away, >= 0. For rotations the rotation vector to put on from the right.
  Vec3 at(bool before, int from_seam) const;

 private:
  Vec3 value_[2], slope_[2];  // after, before; slopes along time
  int width_;
};

SeamCurve rotation_curve(const SeamGap& gap, int width);
SeamCurve position_curve(const SeamGap& gap, int width);

}  // namespace krok
