#pragma once

#include <array>

#include "math/transform.h"

// The gap at the seam between two motions, and the correction curves that close it. Rates are per
// frame. Used by loop().

namespace krok {

// One joint's transforms on both sides, from the seam outwards: before[0] and after[0] are at the
// same time, the others one and two frames away.
struct SeamSides {
  std::array<Transform, 3> before, after;
};

struct SeamGap {
  Vec3 value = Vec3::Zero();  // from end to start; a rotation vector in the end's frame
  // Velocities at the seam, for rotations each in the frame of its own side. From parabolas of
  // equal curvature through the frames of both sides, so that curvature does not count as a
  // velocity jump.
  Vec3 rate_before = Vec3::Zero(), rate_after = Vec3::Zero();

  double jump() const { return (rate_after - rate_before).norm(); }

  // Reduces the velocity jump by `usual`, at most to zero.
  void forgive(double usual);
};

SeamGap rotation_gap(const SeamSides& sides);
SeamGap position_gap(const SeamSides& sides);

// The correction on each side, a quintic Hermite curve per coordinate: half the gap at the seam,
// zero with two derivatives `width` frames away.
class SeamCurve {
 public:
  SeamCurve(const Vec3& value_before, const Vec3& slope_before, const Vec3& value_after,
            const Vec3& slope_after, int width);

  // `from_seam` >= 0: frames from the seam. For rotations a rotation vector to be applied from the
  // right.
  Vec3 at(bool before, int from_seam) const;

 private:
  Vec3 value_[2], slope_[2];  // after, before; slopes per frame
  int width_;
};

SeamCurve rotation_curve(const SeamGap& gap, int width);
SeamCurve position_curve(const SeamGap& gap, int width);

}  // namespace krok
