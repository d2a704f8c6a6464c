#pragma once

#include <span>

#include "scene/clip.h"
#include "scene/model.h"
#include "scene/stretch.h"

// Half-twist joints: joints along a bone that share out a twist, so that linear blend skinning does
// not collapse where it is (the candy wrapper effect). They hold no keys of their own: their
// rotation follows from the joints at both ends of the bone.

namespace krok {

// A bone from a joint to the farthest of its children.
struct TwistBone {
  int joint = 0;  // the bone's
  int count = 1;  // of twist joints, 1 to 8
  // Whose twist about the bone is shared out: that of the joint itself, as at a shoulder, where the
  // surface is not to twist; or that of the child, as at a wrist.
  bool of_start = false;
};

// Adds the twist joints of some bones to a model, at equal distances along the bone, as children of
// the bone's joint, after all other joints: NAME_twist1, NAME_twist2, ... towards the child, or
// NAME_untwist1, ... with `of_start`. The bone's share of each vertex goes to the nearest two of
// them, and of its joint at the end that does not twist, linearly along the bone. Vertices keep
// their 8 largest influences. An Error (code twist-joints) for a joint without a child that is not
// at its own place, with more than 8 or no joints, or with twist joints already.
Status add_twist_joints(Model& model, std::span<const TwistBone> bones);

// Adds the twist joints of `model` that a motion does not have to its skeleton and to each frame.
// The joint at the share f of a bone turns about the bone by f times the twist of the child, or for
// those of the start by f - 1 times that of the bone's joint: rotations from the reference pose of
// `model` relative to the parent are swing * twist. Twists are continued over half a turn from one
// frame to the next. Joints whose bone is not in the motion are left out. `stretches` may be empty.
void carry_twist_joints(const Skeleton& model, Clip& motion, Stretches& stretches);

}  // namespace krok
