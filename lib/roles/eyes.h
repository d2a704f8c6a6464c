#pragma once

#include "scene/skeleton.h"

namespace krok {

// The joints that rotate the eyes; -1 if missing.
struct EyeJoints {
  int left = -1;
  int right = -1;
};

// Finds the eyes by name alone, such as "LeftEye", "eye.L", "lEye", "J_Adj_R_FaceEye": names with
// the word eye and a side, but without a word for a part around the eye or a control (lid, brow,
// lash, target, end and so on). The first match per side.
EyeJoints find_eyes(const Skeleton& skeleton);

}  // namespace krok
