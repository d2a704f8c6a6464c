#pragma once

#include <algorithm>
#include <cmath>

#include "ik/limits.h"

namespace krok::ragdoll {

// Calls side(number, axis, beyond) for each side of a cone that limits: the axis in the child's
// frame, unit, about which turning leads out of the range, and how far it is out, in radians (to
// the first order; below 0 within).
template <typename Side>
void each_cone_side(const ik::JointLimit& limit, const Quat& turn, const Side& side) {
  const ik::LimitAngles angles = ik::measure(limit, turn);
  const ik::LimitGradients slopes = ik::gradients(limit, turn);
  const double twist = slopes.twist.norm();
  if (limit.max_twist - limit.min_twist < 2 * kPi && twist > 1e-6) {
    const Vec3 axis = slopes.twist / twist;
    side(0, axis, (angles.twist - limit.max_twist) / twist);
    side(1, Vec3(-axis), (limit.min_twist - angles.twist) / twist);
  }
  double ratio = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const double swing = angles.swing[k];
    const double half = swing < 0 ? -limit.min_swing[k] : limit.max_swing[k];
    ratio = std::hypot(ratio, swing / std::max(half, 1e-6));
  }
  const double swing = slopes.swing.norm();
  // The slopes are those of the square of the ratio.
  if (swing > 1e-6) side(2, Vec3(slopes.swing / swing), 2 * ratio * (ratio - 1) / swing);
}

}  // namespace krok::ragdoll
