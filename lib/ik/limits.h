#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/clip.h"

// Ranges of motion of joints: hinges with an angle, and cones, which limit swing and twist apart.
// Radians throughout; orientations are joint_to_parent.

namespace krok::ik {

// The range of one joint. A rotation is measured from `zero`: joint_to_parent = zero * swing *
// twist, where the twist turns about `axis` and the swing about a perpendicular of it (the
// swing-twist decomposition, Grassia 1998; Baerlocher and Boulic 2001).
struct JointLimit {
  enum class Kind : unsigned char {
    free,    // any rotation
    locked,  // keeps the rotation it has
    hinge,   // turns about `axis` alone, from min_twist to max_twist
    cone     // swings within an ellipse and twists from min_twist to max_twist
  };
  Kind kind = Kind::free;

  // joint_to_parent, unit, at which all angles are 0. Need not lie within the range of a hinge.
  Quat zero = Quat::Identity();

  // The hinge's or the twist's axis, and for cones the axis of the first swing angle, unit and
  // perpendicular to it. The second swing axis is cross(axis, swing_axis). In the joint's frame.
  Vec3 axis = Vec3::UnitY();
  Vec3 swing_axis = Vec3::UnitX();

  // min <= max. A range of a full turn or more does not limit. Twists of a cone lie in [-pi, pi].
  double min_twist = -kPi, max_twist = kPi;

  // The ellipse's half axes on the negative and positive sides of both swing angles: -pi <= min <=
  // 0 <= max <= pi. Each quadrant has the quarter of an ellipse of its own.
  std::array<double, 2> min_swing = {-kPi, -kPi}, max_swing = {kPi, kPi};

  bool operator==(const JointLimit& other) const;
};

// A skeleton's limits, shape [joints]; empty: none.
using Limits = std::vector<JointLimit>;

// The angles of a rotation. `twist` of a hinge is the one within half a turn of the middle of its
// range; `off_axis` is the angle by which a rotation misses the hinge's axis (0 for cones).
struct LimitAngles {
  double twist = 0;
  std::array<double, 2> swing = {0, 0};
  double off_axis = 0;
};
LimitAngles measure(const JointLimit& limit, const Quat& joint_to_parent);

// The rotation with these angles.
Quat compose(const JointLimit& limit, double twist, const std::array<double, 2>& swing);

// The allowed rotation next to `joint_to_parent`: twist and swing are brought to the nearest
// allowed angles each. Free and locked joints come back as they are; so do rotations within the
// range, bit for bit.
Quat clamped(const JointLimit& limit, const Quat& joint_to_parent);

// Radians between a rotation and its clamped one; 0 within the range.
double excess(const JointLimit& limit, const Quat& joint_to_parent);

// The point next to (a, b) within the quarter ellipses of a cone.
std::array<double, 2> nearest_swing(const JointLimit& limit, const std::array<double, 2>& swing);

// The gradients of a cone's twist angle and of its swing's distance from 0 in units of the ellipse,
// with respect to a rotation r (a rotation vector in the joint's frame) applied as joint_to_parent
// * exp(r).
struct LimitGradients {
  Vec3 twist = Vec3::Zero();
  Vec3 swing = Vec3::Zero();
};
LimitGradients gradients(const JointLimit& limit, const Quat& joint_to_parent);

// Checks everything documented above. Codes: limits-count (not [joints]), limits-value (a value out
// of range or not finite; Diagnostic::joint is the joint's index as text).
Status check(std::span<const JointLimit> limits, int joints);

struct LearnOptions {
  double margin = 0;  // radians added on every side of what was seen, >= 0
};

// The ranges that the joints of `skeleton` use in motions. The zero of each is the mean of the
// rotations seen; the first swing axis is the direction in which the joint swings most; an ellipse
// is the smallest of the shape of the extremes that holds all that was seen. A joint that turns
// about one axis alone (but for the rounding of floats) becomes a hinge, one that never turns
// (within a twentieth of a degree) is locked, the root is free. Every pose of the motions is within
// the limits, hinges' rounding (under 1e-6 rad) apart.
//
// The clips have the joints of `skeleton` in the same order with the same reference orientations
// (within half a degree): code limits-skeleton. No frames: limits-empty.
Result<Limits> learn_limits(const Skeleton& skeleton, std::span<const Clip* const> clips,
                            const LearnOptions& options = {});

}  // namespace krok::ik
