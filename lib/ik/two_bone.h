#pragma once

#include "math/transform.h"

// Two-bone inverse kinematics in closed form: thigh and shank, upper arm and forearm. The triangle
// of the two bones and the line from the root to the target is solved by the law of cosines; the
// direction in which the middle joint points out is set by the caller (the pole).
//
// All points and directions are in one frame (world, or any other), metres and radians. Never
// allocates and never fails: degenerate input is resolved as described at each field.

namespace krok {

struct TwoBoneChain {
  // Present positions of the joints; they define the bone lengths. A bone may have length 0.
  Vec3 root = Vec3::Zero();
  Vec3 middle = Vec3::Zero();
  Vec3 end = Vec3::Zero();

  // The present direction of the middle joint's hinge, of any length: cross(upper, lower) when the
  // joint bends; +X for a knee of a character facing +Z. Needed if the chain may be straight now (a
  // reference pose), which does not define the plane it bends in. Zero: taken from the present
  // bend; if that is straight, the plane of the solution counts as the present one, so that no
  // twist about the bones is added.
  Vec3 hinge = Vec3::Zero();
};

struct TwoBoneGoal {
  Vec3 target = Vec3::Zero();  // desired position of the end

  // The direction, of any length, in which the middle joint should point out from the line between
  // root and target; only its part perpendicular to that line counts. If it is zero or parallel to
  // the line: the present bend, then the hinge, then a fixed perpendicular of the line.
  Vec3 pole = Vec3::Zero();

  // Limits of the bend: the angle between the directions of the two bones, 0 when straight, pi when
  // folded back. 0 <= min_bend <= max_bend <= pi.
  double min_bend = 0;
  double max_bend = kPi;

  // Metres before the longest reach within which the end starts to lag behind the target, so that
  // the middle joint does not snap as the chain straightens: beyond (longest - softness) the reach
  // approaches the longest as 1 - exp(-x). 0: off. Useful up to a tenth of the chain's length.
  double softness = 0;
};

struct TwoBoneSolution {
  Vec3 middle = Vec3::Zero();
  Vec3 end = Vec3::Zero();  // on the line from the root to the target; the target itself if reached
  // Multiply from the left with the joints' present global orientations.
  Quat root_rotation = Quat::Identity();
  Quat middle_rotation = Quat::Identity();
  double bend = 0;       // radians, within the limits
  bool reached = false;  // end equals target within 1e-9 m
};

// How far the solution moves for a small step of target and pole, with bones of lengths u and l, a
// target at distance d, the middle joint `along` the line to it and `out` beside it, and an angle p
// between line and pole (tests/property/ik):
// - the end by the step itself, or less out of reach; nearer than |u - l| by |u - l| / d of it;
// - the middle by u (d - along) / (d out) of a step along the line, u / d of one across it in the
//   plane of the limb, (along + out / tan p) / d at most of one across that plane, and out / sin p
//   for a radian of the pole.
// So it jumps where the bones are in line without softness (out = 0), where the target is at the
// root (d = 0) and where the pole is along the line (p = 0 or pi), and nowhere else. With a
// softness of a tenth of the limb, bones whose lengths differ by a quarter at most, a target at
// half the limb's length or farther, and a pole of the limb's length and at 60 degrees or more to
// the line, the middle moves by at most 1.5 times the step of target and pole.
//
// The pose of the chain that moves its end to the target, or as close as lengths and limits allow.
// For a target at the root the direction from root to end is kept. If both bones have length 0 the
// chain is unchanged and `reached` states whether its end is at the target; values that are not
// finite leave it unchanged with `reached` false.
TwoBoneSolution solve_two_bone(const TwoBoneChain& chain, const TwoBoneGoal& goal);

// The distance, up to `longest`, at which the end stays for a target at `distance`, with a softness
// as in TwoBoneGoal; without softness `distance` itself.
double soft_distance(double distance, double longest, double softness);

// The distance from root to end of two bones with this bend.
double two_bone_reach(double upper_length, double lower_length, double bend);

// The bend at which the bones span `distance`, clamped to [0, pi] if none does.
double two_bone_bend(double upper_length, double lower_length, double distance);

}  // namespace krok
