#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/scene.h"

// The animations of a scene, by name or number.

namespace krok::nodes {

// From the file, as UTF-8, or "animation 3".
std::string animation_name(const Scene& scene, std::size_t index);

// "0 (walk), 1 (run)", of at most 20, for messages.
std::string animation_list(const Scene& scene);

// The animation of that name, else the only one of "ARMATURE|name", else of that number. Code
// clip-name if there is none; `file` is for the message.
Result<int> find_animation(const Scene& scene, const std::string& wanted, const std::string& file);

// An animation, and for messages why it was chosen: "the first of 3 that move any to move at least
// half as many joints as the most: 41 joints".
struct ChosenAnimation {
  int animation = -1;      // -1 for a scene without animations
  std::size_t count = 0;   // what it moves
  std::size_t moving = 0;  // animations that move something
  std::string why;
};
// The first animation for which `count` is at least half of the largest; the first if all are 0.
// `what` is counted: "joint".
ChosenAnimation best_animation(const Scene& scene, const char* what,
                               const std::function<std::size_t(const Animation& animation)>& count);
// By how many nodes move, else by morph targets.
ChosenAnimation best_animation(const Scene& scene);
// By nodes::moved_count().
ChosenAnimation best_animation(const Scene& scene, std::span<const int> joints);

// If there are several: a warning that `chosen` is used and why, with a list of all.
Diagnostics describe_choice(const Scene& scene, const ChosenAnimation& chosen, const char* code,
                            const char* hint, const std::string& file);

// find_animation(), where an empty `wanted` is best_animation(), with a warning (code clip-choice)
// if there are others; -1 for a scene without any, unless one is wanted.
Result<int> choose_animation(const Scene& scene, const std::string& wanted, const std::string& file,
                             Diagnostics& diagnostics);

// What an animation moves. Exporters write constant channels for objects that stand still, so only
// the values of keys show it.

// Whether keys of a channel differ by more than rounding: 1e-4; 1e-5 of the size of translations.
bool changes(const Channel& channel);

// The morph targets whose weights an animation sets, of all its nodes.
int animated_targets(const Animation& animation);

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
