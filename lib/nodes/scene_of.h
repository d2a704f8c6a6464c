#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/evaluate.h"
#include "nodes/scene.h"
#include "scene/scene.h"

namespace krok::nodes {

// The displayed scene of a file: a mesh for each instance, the joints of Evaluator::joints(), all
// animations. In the file's unit and axes. Codes: those of Evaluator::create(), gltf-too-large.
Result<krok::Scene> scene_of(std::shared_ptr<const Scene> from_file);

// The nodes without a mesh in the displayed scene that neither are joints nor carry joints or
// meshes, in the order of evaluation.
std::vector<int> places_of(const Scene& scene, const Evaluator& evaluator);

// The gaps between the key times of an animation (Evaluator::key_times()): shape [times - 1], or
// empty if all are straight.
//
// A channel of cubic splines has 4 parts or more, none of which turns by more than about 15
// degrees. For a value that differs by one cubic between two animations, the largest difference at
// the ends of the parts is at least 1 / 1.3 of the largest anywhere, and 1 / 1.1 if it vanishes at
// the keys (linear programs over the cubics and the nodes 0, 1/4, ..., 1).
std::vector<KeyGap> key_gaps(const Animation& animation, std::span<const double> times);

// The kinds of interpolation of the channels whose value changes: "linear", "linear and step".
// "no" if nothing changes.
std::string interpolation_words(const Animation& animation);

}  // namespace krok::nodes
