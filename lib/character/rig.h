#pragma once

#include <vector>

#include "character/joints.h"
#include "core/result.h"
#include "nodes/evaluate.h"
#include "scene/skeleton.h"

// The skeleton of a scene in its bind pose, and how the scene's transforms, which may scale, become
// the rigid ones that Krok's motions hold.
//
// With G_j(t) the node_to_world of joint j and B_j its inverse bind matrix, the scene shows a
// vertex v at sum_j w_j G_j(t) B_j v. Let X be the mesh_to_world of the bind pose, so that
// F_j = X B_j^-1 is the joint_to_world there, and F_j = C_j S_j with C_j its rigid part. Then
// M_j(t) = G_j(t) S_j^-1 moves X v to the same place by M_j C_j^-1, and it is rigid wherever the
// animation leaves scales as they were: a scale of 0.01 above the whole armature drops out.

namespace krok::character {

struct Rig {
  Joints joints;

  // In the scene's unit and axes (after `to_axes`); the reference pose is the bind pose, C_j.
  Skeleton skeleton;
  std::vector<Mat4> reference;  // F_j, [joints]
  std::vector<Mat3> unscale;    // S_j^-1, [joints]

  // Applied to everything; see rotation_to_apply.
  Mat4 to_axes = Mat4::Identity();

  // M_j without its rounding to a rigid transform.
  Mat4 joint_to_world(const nodes::Evaluation& state, int joint) const;
};

// The bind pose from the inverse bind matrices; joints without one follow their node's transform
// relative to the parent, and so do those that carry no vertices and whose matrix does not fit the
// length and scale of their bone. Any X gives the same motion of the mesh. It is what the nodes
// without animation give; where they stand in another pose than the bind pose, it is the placement
// of the mesh's own node if a joint agrees with it, otherwise that of the topmost joint, or where
// that joint is turned in that pose the rotation by quarter turns that comes nearest to the whole.
// Names are made unique and not empty.
//
// Notes and warnings: scene-joint-names, scene-pose (nodes stand in another pose), scene-bind
// (skins disagree, matrices that cannot be inverted). An Error (code scene-value) where transforms
// are not finite.
Result<Rig> make_rig(const nodes::Scene& scene, const nodes::Evaluator& evaluator, Joints joints,
                     Diagnostics& diagnostics);

// The inverse of an affine matrix, the identity where it has none; `usable` tells which.
Mat4 inverse_or_identity(const Mat4& matrix, bool* usable = nullptr);

// Whether two placements are the same up to the rounding of files: a ten-thousandth of the linear
// part, and of `size` for the position.
bool nearly_same(const Mat4& a, const Mat4& b, double size);

}  // namespace krok::character
