#pragma once

#include "scene/model.h"

namespace krok {

// A stick mesh that shows a skeleton: a thin flat-shaded octahedron from each joint to each of its
// children, rigidly bound to the joint. Bones shorter than a thousandth of the skeleton's extent
// are left out. A skeleton without any bone gets a small octahedron at its first joint. Requires at
// least one joint.
Model bone_mesh(const Skeleton& skeleton);

}  // namespace krok
