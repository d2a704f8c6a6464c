#pragma once

#include "scene/skeleton.h"

namespace krok {

// The joints that turn a figure's eyes, -1 where there is none.
struct EyeJoints {
  int left = -1;
  int right = -1;
};

// By their names alone, in the spellings of "LeftEye", "eye.L", "lEye", "J_Adj_R_FaceEye": a name
// with the word eye and a side, and without a word of what is around an eye or steers it (lid,
// brow, lash, target, end and the like). Of several the first.
EyeJoints find_eyes(const Skeleton& skeleton);

}  // namespace krok
