#pragma once

#include <span>
#include <vector>

#include "body/human_actor.h"

namespace krok::body {

// The orientation of a hand in a pose, and its finger joints.
struct HandLayout {
  Vec3 along = Vec3::UnitX();   // unit, from the wrist to the knuckles
  Vec3 across = Vec3::UnitZ();  // unit, perpendicular to `along`, towards the thumb
  // Chains from knuckle to tip, at least two joints each, starting at the thumb side. Chains within
  // the wrist are left out.
  std::vector<std::vector<int>> fingers;
  std::vector<int> thumb;  // empty if there is none
  // Whether the skeleton has a complete hand. With fewer than three fingers they are placeholders.
  bool whole() const { return fingers.size() >= 3; }
};

HandLayout hand_layout(const Skeleton& skeleton, const HumanActor& actor, std::size_t side,
                       std::span<const Transform> pose);

// `pose` with the fingers of complete hands straightened and spread so that they do not touch.
std::vector<Transform> spread_fingers(const Skeleton& skeleton, const HumanActor& actor,
                                      std::span<const Transform> pose);

}  // namespace krok::body
