#pragma once

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/model.h"

// Binds a model to the skeleton of a motion.

namespace krok {

// The model bound by name to the joints of `skeleton`, that of a motion: the result has the names,
// order and parents of `skeleton` and the model's own reference pose. Joints that only `skeleton`
// has keep their transform relative to the parent; joints that only the model has are dropped,
// which is an Error (code skin-joint-missing) if they influence a vertex. Influences are
// normalised, see normalize_influences.
Result<Model> bind_to(Model model, const Skeleton& skeleton);

// Warns if a motion would distort a model that is bound to its skeleton. The model's reference pose
// may be any pose of that skeleton, since joint offsets do not depend on the pose; so the offset of
// each joint from its parent is compared with the motion's reference pose and all its frames. If
// even the nearest is more than 1 mm off, either the length differs (code skin-proportions: the
// mesh is stretched) or only the direction (code skin-reference: the joint frames differ). At most
// one warning of each kind, for the joint with the largest difference.
Diagnostics reference_differences(const Skeleton& model, const Clip& motion);
// The same of frames that are read on `jobs` threads, if they matter. Errors are those of the
// source.
Result<Diagnostics> reference_differences(const Skeleton& model, const FrameSource& motion,
                                          int jobs);

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

// A stick mesh that shows a skeleton: a thin flat-shaded octahedron from each joint to each of its
// children, rigidly bound to the joint. Bones shorter than a thousandth of the skeleton's extent
// are left out. A skeleton without any bone gets a small octahedron at its first joint. Requires at
// least one joint.
Model bone_mesh(const Skeleton& skeleton);

}  // namespace krok
