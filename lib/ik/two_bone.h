#pragma once

#include "math/types.h"

// Inverse kinematics of two bones in closed form: a thigh and a shank, an upper arm and a forearm.
// The triangle of the two bones and the line from the root to the target is solved by the law of
// cosines; the direction in which the middle joint points out is the caller's choice (the pole).
//
// All points and directions are in one frame (world, or any other), metres and radians. Nothing is
// allocated, and no input makes it fail: what is degenerate is resolved as told at each field.

namespace krok {

struct TwoBoneChain {
  // Where the joints are now; they give the bones' lengths. A bone may have length 0.
  Vec3 root = Vec3::Zero();
  Vec3 middle = Vec3::Zero();
  Vec3 end = Vec3::Zero();

  // The present direction of the middle joint's hinge, of any length: cross(upper, lower) when the
  // joint bends, for a knee of a figure facing +Z that is +X. Needed where the chain may now be
  // straight (a reference pose), which tells nothing of the plane it bends in. Zero: taken from the
  // present bend; if that is straight, the plane of the solution counts as the present one, so that
  // no twist about the bones is added.
  Vec3 hinge = Vec3::Zero();
};

struct TwoBoneGoal {
  Vec3 target = Vec3::Zero();  // where the end shall be

  // The direction, of any length, in which the middle joint shall point out from the line between
  // root and target; only its part perpendicular to that line counts. Where it is zero or parallel
  // to the line, the present bend decides, then the hinge, then a fixed perpendicular of the line.
  Vec3 pole = Vec3::Zero();

  // Limits of the bend: the angle between the directions of the two bones, 0 when straight, pi when
  // folded back. 0 <= min_bend <= max_bend <= pi.
  double min_bend = 0;
  double max_bend = kPi;

  // Metres before the longest reach within which the end begins to lag behind the target, so that
  // the middle joint does not snap as the chain straightens: beyond (longest - softness) the reach
  // approaches the longest as 1 - exp(-x). 0: off. At most a tenth of the chain makes sense.
  double softness = 0;
};

struct TwoBoneSolution {
  Vec3 middle = Vec3::Zero();
  Vec3 end = Vec3::Zero();  // on the line from the root to the target; the target itself if reached
  // To be multiplied from the left to the joints' present global orientations.
  Quat root_rotation = Quat::Identity();
  Quat middle_rotation = Quat::Identity();
  double bend = 0;       // radians, within the limits
  bool reached = false;  // end equals target within 1e-9 m
};

// The pose of the chain that brings its end to the target, or as near to it as lengths and limits
// allow. A target at the root keeps the present direction from root to end. A chain of two bones of
// length 0, and any value that is not finite, gives the chain as it is, with reached telling
// whether it happens to be there.
TwoBoneSolution solve_two_bone(const TwoBoneChain& chain, const TwoBoneGoal& goal);

// The distance from root to end of two bones that meet at `bend`.
double two_bone_reach(double upper_length, double lower_length, double bend);

// The bend at which the bones span `distance`, clamped to [0, pi] where none does.
double two_bone_bend(double upper_length, double lower_length, double distance);

}  // namespace krok
