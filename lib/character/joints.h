#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/evaluate.h"
#include "nodes/scene.h"

// Selects the nodes of a scene that are the joints of a character.

namespace krok::character {

struct Joints {
  std::vector<int> nodes;    // [joints] of the scene; -1 for a root added above several trees
  std::vector<int> parents;  // [joints] indices into `nodes`, before children; -1 for the first
  std::vector<int> skins;    // skins of the scene bound to these joints, in scene order

  // [nodes] the joint that moves a node: itself or the nearest ancestor; the first joint for meshes
  // that move as little as it, not at all; -1 if none.
  std::vector<int> node_to_joint;

  int count() const { return static_cast<int>(nodes.size()); }
};

// Selects one tree with one root.
//
// With skins: their joints, the nodes between these up to the lowest common ancestor, and
// descendants that are animated or carry no mesh, camera or light (ends of bones, sockets, props).
// Above the common ancestor, in either case, the nodes up to the topmost one that the file calls a
// joint, that is named as hips, or that is animated and has animated nodes of its own beside the
// others (legs that no skin has); not past a node with joints of another skeleton.
// Skins belong to one skeleton if they share a joint, if the joints of one are below those of the
// other, or if their common ancestor has no skinned mesh. Of several skeletons the one with the
// most joints is selected, or the one of the skin given by `skin` (its name, or its number from 0);
// either is reported in `diagnostics` (code scene-skeletons).
//
// Without skins: the animated nodes and their descendants without a mesh, camera or
// light; without animations all nodes of the displayed scene except cameras and lights.
//
// Animated nodes that belong to none of that are a warning, other nodes without a mesh, camera or
// light a note (code scene-left-out).
//
// Joints have the order of the skin, if it lists all of them with parents first, otherwise depth
// first. Codes: scene-skeleton (there is none), scene-skin (no skin of that name), scene-joints
// (more than 65,535).
Result<Joints> choose_joints(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                             const std::string& skin, Diagnostics& diagnostics);

// Names a part of a scene in messages: "skin 2 (Body)", "node 7".
std::string label(const char* kind, int index, const std::string& name);

struct BindPose {
  std::vector<Mat4> joint_to_world;  // F_j of rig.h, [joints]
  std::vector<char> weighted;        // [joints] whether a vertex is bound to it
};

// See make_rig in rig.h; `to_axes` as in Rig. Warnings and notes: scene-bind, scene-pose.
BindPose find_bind_pose(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                        const Joints& joints, const Mat4& to_axes, Diagnostics& diagnostics);

}  // namespace krok::character
