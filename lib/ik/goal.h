#pragma once

#include <vector>

#include "math/transform.h"

namespace krok::ik {

// What a solver is to bring about; metres, radians, world space.
struct Goal {
  enum class Kind : unsigned char {
    position,     // `point` of the joint at `target`
    orientation,  // the joint's orientation equals `orientation`
    pose,         // both
    look_at,      // `axis` of the joint points from `point` of it to `target`
    pole,         // the bend of upper-joint-lower points towards `target`
    balance       // the centre of mass above `support`
  };
  Kind kind = Kind::position;

  int joint = 0;  // the end effector; for a pole the middle joint; not used by balance

  Vec3 point = Vec3::Zero();  // in the joint's frame
  Vec3 target = Vec3::Zero();
  Quat orientation = Quat::Identity();
  Vec3 axis = Vec3::UnitZ();  // in the joint's frame, unit

  // Target and orientation are in the frame of this joint, wherever the solution moves it to; -1:
  // in the world. Not used by balance. The joint itself takes part only where it is on some goal's
  // chain.
  int anchor = -1;

  // For a pole: a joint above the middle one and one below it, by default (-1) its parent and its
  // first child. A limb that is straight, or a target on its line, has no bend to point: such a
  // goal counts as reached.
  int upper = -1, lower = -1;

  // For balance: a convex polygon on the ground (x, z), counter-clockwise seen from below or above,
  // or one or two points. A centre of mass above its inside is balanced.
  std::vector<Vec2> support;

  // How much the goal counts beside others that cannot all be reached, > 0: factor of its error.
  double weight = 1;

  // How many joints take part, from the end effector's own (1 rotates it alone) upwards; 0: all.
  int depth = 0;
};

// How far a goal is missed.
struct Residual {
  double distance = 0;  // metres: position, pose, and balance
  double angle = 0;     // radians: orientation, pose, look-at, pole
  bool reached = false;

  // Of a goal that is not reached: the joint whose limit, by being less tight, would bring it
  // nearer by the most; -1: no limit is in the way, it is out of reach of the chain (or in conflict
  // with another goal).
  int held_by = -1;
};

}  // namespace krok::ik
