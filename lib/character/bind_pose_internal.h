#pragma once

#include <vector>

#include "character/joints.h"
#include "core/result.h"
#include "nodes/evaluate.h"

// Private to this folder: the transforms of joints in the bind pose.

namespace krok::character {

struct BindPose {
  std::vector<Mat4> joint_to_world;  // F_j of rig.h, [joints]
  std::vector<char> weighted;        // [joints] whether a vertex is bound to it
};

// See make_rig in rig.h; `to_axes` as in Rig. Warnings and notes: scene-bind, scene-pose.
BindPose find_bind_pose(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                        const Joints& joints, const Mat4& to_axes, Diagnostics& diagnostics);

}  // namespace krok::character
