#pragma once

#include <vector>

#include "character/joints.h"
#include "core/result.h"
#include "nodes/evaluate.h"
#include "scene/skeleton.h"

// The skeleton of a scene in its bind pose, and the conversion of the scene's transforms, which may
// scale, to the rigid ones of Krok's motions.
//
// With G_j(t) the node_to_world of joint j and B_j its inverse bind matrix, the scene shows a
// vertex v at sum_j w_j G_j(t) B_j v. Let X be the mesh_to_world of the bind pose, so that F_j = X
// B_j^-1 is the joint_to_world there, and F_j = C_j S_j with C_j its rigid part. Then M_j(t) =
// G_j(t) S_j^-1 moves X v to the same position by M_j C_j^-1, and it is rigid wherever the
// animation does not change scales: a scale of 0.01 above the whole armature cancels out.

namespace krok::character {

struct Rig {
  Joints joints;

  // In the scene's unit and axes (after `to_axes`); the reference pose is the bind pose, C_j.
  Skeleton skeleton;
  std::vector<Mat4> reference;  // F_j, [joints]
  std::vector<Mat3> unscale;    // S_j^-1, [joints]

  // Whether the scene has a mesh; else its nodes without animation are in any pose.
  bool has_mesh = true;

  // Applied to everything; see rotation_to_apply.
  Mat4 to_axes = Mat4::Identity();

  // M_j before it is made rigid.
  Mat4 joint_to_world(const nodes::Evaluation& state, int joint) const;
};

// The bind pose from the inverse bind matrices. Joints without one follow their node's transform
// relative to the parent, as do joints without vertices whose matrix does not match the length and
// scale of their bone. Any X gives the same motion of the mesh. It is the one given by the nodes
// without animation; if these are in another pose than the bind pose, it is the transform of the
// mesh's own node if a joint agrees with it, otherwise that of the topmost joint, or if that joint
// is rotated in that pose, the rotation by multiples of 90 degrees that best fits all joints. Names
// are made unique and not empty.
//
// Notes and warnings: scene-joint-names, scene-pose (nodes are in another pose), scene-bind (skins
// disagree, matrices that cannot be inverted). An Error (code scene-value) if transforms are not
// finite.
Result<Rig> make_rig(const nodes::Scene& scene, const nodes::Evaluator& evaluator, Joints joints,
                     Diagnostics& diagnostics);

// The inverse of an affine matrix, or the identity if it is singular; `usable` returns which.
Mat4 inverse_or_identity(const Mat4& matrix, bool* usable = nullptr);

// Whether two transforms are equal up to rounding in files: 1e-4 of the linear part, and of `size`
// for the position.
bool nearly_same(const Mat4& a, const Mat4& b, double size);

}  // namespace krok::character
