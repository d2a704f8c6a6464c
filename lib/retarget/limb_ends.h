#pragma once

#include <vector>

#include "scene/frame_source.h"
#include "scene/model.h"
#include "scene/motion_keys.h"

// Characters whose limbs end at elbows and knees, as blocky ones of games: motions are moved onto
// them with hands and feet that are added for that and left out of the result.

namespace krok::retarget {

// The model's skeleton with a joint, "forearm.L_end", at the far end of the mesh of each forearm
// and shin by name that has no child, or where the hand or foot of that name is that hangs
// elsewhere, as the goals of inverse kinematics do: behind all others, and only where the skeleton
// is humanoid with them and not without.
Skeleton with_limb_ends(const Model& model);

// Of each joint, that one of the last `count` with which it goes, as a hand or foot that hangs
// elsewhere and all below it; -1 of others.
std::vector<int> carrying_ends(const Skeleton& skeleton, int count);

// Frames without the last `count` joints, which have no children but each other. Hands and feet
// that hang elsewhere are where these were, with all below them. Contacts become those of such a
// joint, or of the parent.
FrameSource without_last_joints(FrameSource frames, int count);
Clip without_last_joints(Clip clip, int count);
void give_to_parents(const Skeleton& skeleton, int count, std::vector<Contact>& contacts);

}  // namespace krok::retarget
