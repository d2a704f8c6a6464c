#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/evaluate.h"
#include "nodes/scene.h"

// Which nodes of a scene are the joints of a character.

namespace krok::character {

struct Joints {
  std::vector<int> nodes;    // [joints] of the scene; -1 for a root that stands above several trees
  std::vector<int> parents;  // [joints] places in `nodes`, before their children; -1 for the first
  std::vector<int> skins;    // of the scene that are bound to these joints, in its order

  std::vector<int> node_to_joint;  // [nodes] the joint that moves a node: itself or the nearest one
                                   // above it; -1 for nodes under none

  int count() const { return static_cast<int>(nodes.size()); }
};

// Chooses one tree with one root.
//
// With skins: their joints, the nodes between them up to the one that all hang under, and the bare
// nodes below (ends of bones, sockets, moved props) that carry no mesh and no camera. Skins belong
// to one skeleton where they share a joint, where one's joints hang under the other's, and where
// the node above both carries no skinned mesh. Of several skeletons the one with the most joints is
// taken, or the one of the skin that `skin` names (its name, or its number from 0); both is said in
// `diagnostics` (code scene-skeletons).
//
// Without skins: the nodes that animations move and what is bare below them; without animations all
// nodes of the scene that is shown, cameras apart.
//
// Joints come in the order of the skin, if it names them all and parents first, otherwise depth
// first. Codes: scene-skeleton (there is none), scene-skin (no skin of that name), scene-joints
// (more than 65,535).
Result<Joints> choose_joints(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                             const std::string& skin, Diagnostics& diagnostics);

// "skin 2 (Body)", "node 7": how messages name a part of a scene.
std::string label(const char* kind, int index, const std::string& name);

}  // namespace krok::character
