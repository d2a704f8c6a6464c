#pragma once

#include <span>
#include <vector>

#include "body/human_actor.h"

namespace krok::body {

// How a hand lies in a pose, and which of its joints are fingers.
struct HandLayout {
  Vec3 along = Vec3::UnitX();   // unit, from the wrist to the knuckles
  Vec3 across = Vec3::UnitZ();  // unit, perpendicular, to the thumb's side
  // Chains from the knuckle to the tip, two joints or more each, from the thumb's side on.
  std::vector<std::vector<int>> fingers;
  std::vector<int> thumb;  // empty where there is none
  // Three fingers or more: the skeleton has a whole hand. Otherwise the fingers are a stand-in.
  bool whole() const { return fingers.size() >= 3; }
};

HandLayout hand_layout(const Skeleton& skeleton, const HumanActor& actor, std::size_t side,
                       std::span<const Transform> pose);

// `pose` with the fingers of whole hands straight and fanned out, so that none touches another.
std::vector<Transform> spread_fingers(const Skeleton& skeleton, const HumanActor& actor,
                                      std::span<const Transform> pose);

}  // namespace krok::body
