#pragma once

#include <array>

#include "scene/skeleton.h"

// The walking actor: a skeleton of 24 joints and 5 end sites with MotionBuilder names, in a T-pose
// facing +Z on the ground; all reference orientations are the identity.

namespace krok::samples {

enum class Side : unsigned char { left = 0, right = 1 };

// +1 for left, -1 for right: the sign of x on that side.
inline double side_sign(Side side) {
  return side == Side::left ? 1.0 : -1.0;
}
inline Side other(Side side) {
  return side == Side::left ? Side::right : Side::left;
}

struct LegJoints {
  int upper = -1, lower = -1, foot = -1, toes = -1;
};
struct ArmJoints {
  int collar = -1, upper = -1, lower = -1, hand = -1, fingers = -1;
};

struct Actor {
  double stature = 0;  // metres
  Skeleton skeleton;
  int hips = -1, spine = -1, spine1 = -1, spine2 = -1, neck = -1, head = -1;
  std::array<LegJoints, 2> legs;  // [Side]
  std::array<ArmJoints, 2> arms;  // [Side]

  double thigh = 0;  // metres, hip to knee
  double shank = 0;  // metres, knee to ankle

  // Points of the sole, relative to the foot joint (the ankle) in the reference pose; identical for
  // both feet, in the sagittal plane of the ankle.
  Vec3 heel = Vec3::Zero();
  Vec3 ball = Vec3::Zero();  // below the toe joint
  Vec3 toe_tip = Vec3::Zero();
  Vec3 toe_joint = Vec3::Zero();  // LeftToeBase itself
};

// An actor of the given stature (metres, > 0). Proportions after Drillis and Contini (1966) as
// given by Winter, "Biomechanics and Motor Control of Human Movement".
Actor make_actor(double stature);

}  // namespace krok::samples
