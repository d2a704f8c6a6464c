#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "nodes/scene.h"

// What an animation moves. Exporters write constant channels for objects that stand still, so only
// the values of keys show it.

namespace krok::nodes {

// Whether keys of a channel differ by more than rounding: 1e-4; 1e-5 of the size of translations.
bool changes(const Channel& channel);

// [nodes] 1 where the node's transform relative to its parent changes.
std::vector<char> moved_nodes(const Scene& scene, const Animation& animation);

// How many of `nodes` change relative to their parents (-1 is skipped); if none, how many nodes
// above them.
std::size_t moved_count(const Scene& scene, const Animation& animation, std::span<const int> nodes);

// How many channels change the camera at a node: those of the node, of nodes above it, of its lens.
std::size_t camera_count(const Scene& scene, const Animation& animation, int node);

// How many morph targets have weights that change.
std::size_t target_count(const Animation& animation);

}  // namespace krok::nodes
