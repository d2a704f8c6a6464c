#pragma once

#include "core/result.h"
#include "scene/model.h"

namespace krok {

// Warns of a reference pose that is not the pose of the mesh (code skin-reference-pose): joints
// then turn vertices about places outside of the body, and skinning distorts it. Such are bones,
// from a joint that moves vertices to a child, that lie outside of the mesh at a quarter, the
// middle and three quarters of their length, if they are more than a twentieth of the length of
// all. Bones shorter than 2 % of the skeleton's extent do not count. Inside is a generalised
// winding number of at least 1/4 either way (Jacobson, Kavan, Sorkine-Hornung, Robust
// Inside-Outside Segmentation Using Generalized Winding Numbers, SIGGRAPH 2013), so that meshes may
// have holes; no warning where three quarters are outside of a mesh that is not closed, such as
// one of sheets.
Diagnostics reference_pose_faults(const Model& model);

}  // namespace krok
