#pragma once

#include "scene/model.h"

namespace krok {

// A thin mesh that makes a skeleton visible: for each joint and each of its children a slender
// double pyramid between them that moves with the joint, flat-shaded. Bones shorter than a
// thousandth of the figure's size are left out. A skeleton without any bone gets a small double
// pyramid at its first joint. Needs at least one joint.
Model bone_mesh(const Skeleton& skeleton);

}  // namespace krok
